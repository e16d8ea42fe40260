// Logarithmic axes: which range of decades, which marks, and which of them are named.

const SUPERSCRIPTS = '⁰¹²³⁴⁵⁶⁷⁸⁹';

/** A digit times a power of ten: plain near one, else raised. */
function tickText(digit, power) {
  if (power >= -3 && power <= 4) return String(Number((digit * 10 ** power).toPrecision(2)));
  const digits = [...String(Math.abs(power))].map((d) => SUPERSCRIPTS[d]).join('');
  return `${digit === 1 ? '' : `${digit}×`}10${power < 0 ? '⁻' : ''}${digits}`;
}

// Digits by how round they are. Two and more of the last lie in any 0.3 decades.
const ROUNDNESS = [[1], [2, 5], [1.5, 3, 7], [1.2, 2.5, 4, 6, 8]];
const ENOUGH_NAMES = 3;

/**
 * The axis over positive values, `length` long, on which a mark's text wants `room(text)`: from
 * `low` to `high` (exponents of ten, with some air), and its marks as {at, text, minor}, `at` an
 * exponent too. Decades are named; where they are few so are 2 and 5, then further digits, as far
 * as there is room.
 */
function logAxis(values, length, room) {
  const powers = values.map(Math.log10);
  let [low, high] = [Math.min(...powers), Math.max(...powers)];
  const air = Math.max(0.08 * (high - low), 0.15);
  [low, high] = [low - air, high + air];
  const every = Math.ceil((high - low) / 9);
  const marks = new Map();
  const mark = (digit, power) => {
    const at = power + Math.log10(digit);
    if (at >= low && at <= high && !marks.has(at)) marks.set(at, { at, text: '', minor: digit !== 1 });
    return marks.get(at);
  };
  const all = [];
  for (let power = Math.floor(low); power <= high; power += 1) all.push(power);
  for (const power of all) for (const digit of every > 1 ? [1] : [1, 2, 3, 4, 5, 6, 7, 8, 9]) mark(digit, power);
  const named = [];
  for (const digits of ROUNDNESS) {
    if (named.length >= ENOUGH_NAMES) break;
    for (const power of all.filter((n) => n % every === 0)) {
      for (const digit of digits) {
        const made = mark(digit, power);
        const text = tickText(digit, power);
        const near = (other) => Math.abs(other.at - made.at) / (high - low) * length < (room(other.text) + room(text)) / 2;
        if (!made || named.some(near)) continue;
        made.text = text;
        named.push(made);
      }
    }
  }
  return { low, high, marks: [...marks.values()] };
}
