// ---- contact: dots where the object touches obstacles, an arrow for each force on one from its centre of pressure --------------------
const arrows = run.touch.arrows.map(arrow => ({ starts: decode(arrow.starts, Float32Array), ways: decode(arrow.ways, Float32Array) }));
const firsts = run.touch.counts.reduce((sums, count) => [...sums, sums[sums.length - 1] + count], [0]);
let dots, pointers;

function build_touch() {
  dots = { program: program("dot-vertex", "dot-fragment"), array: vertices([{ data: decode(run.touch.places, Float32Array), width: 3, type: gl.FLOAT }]) };
  pointers = { program: program("arrow-vertex", "flat-fragment"), array: gl.createVertexArray() };
}
// What the surface hides shows through it.
function draw_touch(common) {
  const frame = frame_shown(), scale = canvas.height / 400, count = run.touch.counts[frame];
  for (const [depth, opacity] of [[gl.GREATER, 0.45], [gl.LEQUAL, 1]]) {
    gl.depthFunc(depth);
    if (count) {
      use(dots.program, { ...common, diameter: 6 * scale, mark: [...run.touch.mark, opacity], outline: run.touch.outline });
      gl.bindVertexArray(dots.array);
      gl.drawArrays(gl.POINTS, firsts[frame], count);
    }
    gl.bindVertexArray(pointers.array);
    for (const { starts, ways } of arrows) {
      const start = starts.subarray(3 * frame, 3 * frame + 3), way = ways.subarray(3 * frame, 3 * frame + 3);
      if (way.every(part => part === 0)) continue;
      for (const [extra, tint] of [[1.4 * scale, run.touch.outline], [0, run.touch.mark]]) {
        use(pointers.program, { ...common, start, end: plus(start, 1, way), width: 4.5 * scale, extra, ink: [...tint, opacity] });
        gl.drawArrays(gl.TRIANGLES, 0, 9);
      }
    }
  }
  gl.depthFunc(gl.LEQUAL);
}
