// ---- turns as unit quaternions [w, x, y, z], in the page and in its worker -----------------------------------------------
const UNTURNED = [1, 0, 0, 0];
const product = ([a, b, c, d], [e, f, g, h]) =>
  [a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];
const backwards = ([w, x, y, z]) => [w, -x, -y, -z];
const turned = (turn, vector) => product(product(turn, [0, ...vector]), backwards(turn)).slice(1);
// A rotation vector [rad] as a turn, and back, the short way round.
function turn_of(vector) {
  const angle = Math.hypot(...vector);
  return angle > 0 ? [Math.cos(angle / 2), ...vector.map(x => Math.sin(angle / 2) * x / angle)] : UNTURNED;
}
function vector_of([w, ...axis]) {
  const size = Math.hypot(...axis), angle = 2 * Math.atan2(size, Math.abs(w));
  return axis.map(x => size > 0 ? Math.sign(w || 1) * angle * x / size : 0);
}
