// Draws the page of two runs: `data.comparison` is what pelt compare --json prints, `data.frame_ms` all frames of both.
const sides = ['a', 'b'].map((key) => ({
  key, letter: key.toUpperCase(), name: data.comparison[key], frames: data.frame_ms[key],
  median: data.comparison.costs[0][key + '_ms'], worst: Math.max(...data.frame_ms[key]),
}));

function fillFacts() {
  const {digest, rounds} = data.comparison;
  const facts = sides.map(({letter, name}) => [letter, name]);
  if (rounds > 1) facts.push(['rounds', rounds]);
  facts.push(['digest', !digest ? 'not compared' : digest.same ? `same: ${digest.a}` : `differs: A ${digest.a || 'changes'}, B ${digest.b || 'changes'}`]);
  for (const [name, value] of facts) {
    const pair = add(byId('facts'), 'div');
    add(pair, 'dt', {}, name);
    add(pair, 'dd', name === 'digest' ? {class: 'digest'} : {}, value);
  }
}

// Both to one scale.
function drawFrames() {
  const top = framesTop(Math.max(...sides.map((s) => s.median)), Math.max(...sides.map((s) => s.worst)));
  byId('frames').replaceChildren();
  const parts = sides.map(() => add(byId('frames'), 'div'));  // both first: they share the width
  const cut = sides.map(({letter, frames, median, worst}, s) => {
    const part = parts[s], head = `${letter}: median ${ms(median)} ms, worst ${ms(worst)} ms`;
    add(part, 'h3', {}, head);
    return plotFrames(add(part, 'div'), {
      columns: frames.map((value, i) => ({ms: value, frame: i, tip: () => `${letter}, frame ${i}: ${ms(value)} ms`})),
      top, picture: 'frames',
      label: `Times of ${frames.length} frames against 5 and 8 ms. ${head}.`,
      drawBelow: ({svg, x, y}) => {
        const steps = frames.map((value, i) => `V${y(value).toFixed(1)}H${x(i + 1).toFixed(1)}`).join('');
        add(svg, 'path', {class: 'band s0', d: `M${x(0)} ${y(0)}${steps}V${y(0)}Z`});
        add(svg, 'line', {class: 'frame-line', x1: x(0), x2: x(frames.length), y1: y(median), y2: y(median)});
      },
    });
  });
  const notes = ['Wall time, in ms, of the frames in which stages were not timed; the thin line is the median. Both pictures have one scale.'];
  if (data.comparison.rounds > 1) notes.push('The frames of all rounds, one round after the other.');
  if (cut[0] + cut[1]) notes.push(`${cut[0]} frames of A and ${cut[1]} of B are cut off at ${+top.toFixed(1)} ms, with what the slowest took above them.`);
  byId('frames-note').textContent = notes.join(' ');
}

function fillTables() {
  const {settings, costs, confidence, pairs, rows, unsure} = data.comparison;
  byId('same').hidden = settings.length > 0;
  const text = (value) => ({text: value ?? '', class: 'text'});
  if (settings.length) table(byId('settings'), 'What differs', ['differs', 'A', 'B'], settings.map((s) => [s.differs, text(s.a), text(s.b)]));
  byId('costs-note').textContent = 'Medians, ms: wall time of the frame, core time of stages, layers and characters. ' +
      (confidence ? `From and to: ${(100 * confidence).toFixed(0)} % intervals of B/A for all ${rows} rows together, by ranks of ${pairs} pairs.` : 'Too few pairs for intervals.') +
      unsure.map((why) => ` UNSURE: ${why}.`).join('');
  const cell = (value, digits) => value === undefined ? '' : value.toFixed(digits);
  table(byId('costs'), 'Costs of both', ['median ms', 'A', 'B', 'B/A', 'from', 'to', 'B is'], costs.map((c) => [
    c.of, cell(c.a_ms, 4), cell(c.b_ms, 4), cell(c.ratio, 3), cell(c.low, 3), cell(c.high, 3),
    {text: c.verdict ?? '', class: c.verdict === 'slower' ? 'text over' : 'text'}]));
}

fillFacts();
fillTables();
drawFrames();
let drawnWidth = innerWidth;
addEventListener('resize', () => {
  if (drawnWidth === innerWidth) return;
  drawnWidth = innerWidth;
  drawFrames();
});
