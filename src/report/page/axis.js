// Logarithmic axes: which decades, which marks, how figures are written.

const DIGITS = '⁰¹²³⁴⁵⁶⁷⁸⁹';

/** 10 to a whole power, as text: plain near one, else raised. */
function powerText(power) {
  if (power >= -3 && power <= 4) return (10 ** power).toFixed(Math.max(0, -power));
  const digits = [...String(Math.abs(power))].map((d) => DIGITS[d]).join('');
  return `10${power < 0 ? '⁻' : ''}${digits}`;
}

/** Three digits that count. */
function figureText(number) {
  if (number === 0) return '0';
  const size = Math.abs(number);
  if (size >= 1e-3 && size < 1e6) {
    return size >= 1000 ? String(Math.round(number)) : String(Number(number.toPrecision(3)));
  }
  const power = Math.floor(Math.log10(size));
  return `${Number((number / 10 ** power).toPrecision(2))}×${powerText(power).replace(/^[01.]+$/, `10${power}`)}`;
}

/**
 * The axis over positive values: from `low` to `high` (exponents of ten, with some air), and its
 * marks as {value, text, minor}. A short axis names 2 and 5 between the decades too.
 */
function logAxis(values) {
  const powers = values.map(Math.log10);
  let [low, high] = [Math.min(...powers), Math.max(...powers)];
  const air = Math.max(0.08 * (high - low), 0.15);
  [low, high] = [low - air, high + air];
  const decades = high - low;
  const every = Math.ceil(decades / 9);
  const marks = [];
  for (let power = Math.floor(low); power <= high; power += 1) {
    for (const digit of every > 1 ? [1] : [1, 2, 3, 4, 5, 6, 7, 8, 9]) {
      const at = power + Math.log10(digit);
      if (at < low || at > high) continue;
      const named = digit === 1 ? power % every === 0 : decades < 2.2 && (digit === 2 || digit === 5);
      const text = digit === 1 ? powerText(power) : figureText(digit * 10 ** power);
      marks.push({ at, text: named ? text : '', minor: digit !== 1 });
    }
  }
  return { low, high, marks };
}
