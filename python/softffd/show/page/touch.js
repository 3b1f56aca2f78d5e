// ---- contact: dots where the object touches obstacles, an arrow for each force on one from its centre of pressure --------------------
const HANDLE = [0, 0.62, 0.45];                          // colour of what a hand may take
let dots, pointers;

function build_touch() {
  dots = { program: program("dot-vertex", "dot-fragment"), places: gl.createBuffer(), array: gl.createVertexArray() };
  gl.bindVertexArray(dots.array);
  gl.bindBuffer(gl.ARRAY_BUFFER, dots.places);
  gl.enableVertexAttribArray(0);
  gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
  gl.bindVertexArray(null);
  pointers = { program: program("arrow-vertex", "flat-fragment"), array: gl.createVertexArray() };
}
function draw_dots(common, places, diameter, mark) {
  if (!places.length) return;
  gl.bindBuffer(gl.ARRAY_BUFFER, dots.places);
  gl.bufferData(gl.ARRAY_BUFFER, places, gl.DYNAMIC_DRAW);
  use(dots.program, { ...common, diameter, mark, outline: run.outline });
  gl.bindVertexArray(dots.array);
  gl.drawArrays(gl.POINTS, 0, places.length / 3);
}
// What the surface hides shows through it.
function draw_touch(common, body) {
  const { places, arrows, handles = [] } = source.touch(body), scale = common.viewport[1] / 400;
  for (const [depth, opacity] of [[gl.GREATER, 0.45], [gl.LEQUAL, 1]]) {
    gl.depthFunc(depth);
    draw_dots(common, places, 6 * scale, [...run.mark, opacity]);
    draw_dots(common, handles, 11 * scale, [...HANDLE, opacity]);
    gl.bindVertexArray(pointers.array);
    for (const [start, way, mark = run.mark] of arrows) {
      if (way.every(part => part === 0)) continue;
      for (const [extra, tint] of [[1.4 * scale, run.outline], [0, mark]]) {
        use(pointers.program, { ...common, start, end: plus(start, 1, way), width: 4.5 * scale, extra, ink: [...tint, opacity] });
        gl.drawArrays(gl.TRIANGLES, 0, 9);
      }
    }
  }
  gl.depthFunc(gl.LEQUAL);
}
