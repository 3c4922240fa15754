// ---- Controls: a row for each setting, and for each key of each layer ------------------------------------------------

// What the original demonstration had on its panel, by our names.
const kScorpion = [['key', 'fur_texture_repeat', 'fur texture multiplier', 1, 80], ['key', 'fur_shadow', 'shadow factor'], ['key', 'stiffness', 'stiffness'],
  ['key', 'fur_density', 'density'], ['key', 'fur_min_length', 'min length'], ['key', 'length', 'max length'], ['key', 'shells', 'shells'], ['setting', 'animation_speed', 'animation speed'],
  ['setting', 'wind_speed', 'wind strength'], ['setting', 'render_fur', 'render fur'], ['key', 'cone', 'cone of shame']];

// Of the scene's setups, the one whose layers are shown, copied and replaced.
let shownSetup = 0;
const rowsOf = (layer) => described.keys.map((key, i) => ({...key, value: layer.values[i]}));

function makeControls() {
  const shown = new Set([...$('controls').querySelectorAll('details[open]')].map((group) => group.dataset.group));
  const first = !$('controls').firstChild;
  $('controls').replaceChildren();
  shownSetup = Math.min(shownSetup, Math.max(described.setups.length - 1, 0));
  const layers = described.setups[shownSetup]?.layers ?? [];
  const shells = layers.find((layer) => rowsOf(layer).some((row) => row.key === 'output' && row.value === '"shells"'));
  if (shells) addScorpion(addGroup('Furry Scorpion', first || shown.has('Furry Scorpion')), shells);
  for (const row of described.settings) addSetting(addGroup(row.group, first ? ['time', 'wind'].includes(row.group) : shown.has(row.group)), row);
  if (described.setups.length > 1) addSetupChoice(addGroup('character', true));
  for (const layer of layers) {
    const group = addGroup(`layer ${layer.name}`, shown.has(`layer ${layer.name}`));
    group.dataset.layer = layer.name;
    for (const row of rowsOf(layer)) addKey(group, layer, row, false);
  }
  find();
  showCosts();
  showGroom();
}

function addScorpion(group, shells) {
  for (const [kind, key, label, low, high] of kScorpion) {
    const row = (kind === 'setting' ? described.settings : rowsOf(shells)).find((r) => r.key === key);
    if (kind === 'setting') addSetting(group, {...row, label});
    else addKey(group, shells, {...row, label, low: low ?? row.low, high: high ?? row.high}, high !== undefined);
  }
  const quit = element('button', {textContent: 'Stop', onclick: () => play(false)});
  addRow(group, {label: 'quit', text: 'the frame that is shown is the last'}, 'quit', [quit]);
}

function addSetupChoice(group) {
  const select = element('select', {});
  for (const [i, {name}] of described.setups.entries()) select.append(element('option', {value: i, textContent: name, selected: i === shownSetup}));
  select.onchange = () => {
    shownSetup = Number(select.value);
    makeControls();
  };
  addRow(group, {label: 'setup of', text: 'whose layers are below, and are copied'}, 'setup', [select]);
}

function addGroup(name, isOpen) {
  let group = [...$('controls').children].find((child) => child.dataset.group === name);
  if (group) return group;
  group = document.createElement('details');
  group.dataset.group = name;
  group.open = isOpen;
  group.innerHTML = '<summary></summary>';
  group.firstChild.textContent = name;
  $('controls').append(group);
  return group;
}

let rowCount = 0;
// A control of a row: {label, unit, text, low, high}, its value, and what a change does. `input` makes the element.
function addRow(group, row, id, inputs) {
  const box = document.createElement('div');
  box.className = 'row';
  box.dataset.key = id;
  const label = document.createElement('label');
  label.htmlFor = `row${rowCount}`;
  label.textContent = `${row.label ?? row.key.replaceAll('_', ' ')}${row.unit ? `, ${row.unit}` : ''} `;
  const note = document.createElement('small');
  note.textContent = row.text;
  label.append(note);
  inputs[0].id = `row${rowCount++}`;
  for (const other of inputs.slice(1)) other.setAttribute('aria-label', `${label.textContent}, as a number`);
  box.append(label, ...inputs);
  group.append(box);
  return box;
}

// And has the other control of the same key, if there is one, show the same.
function markChanged(box) {
  const now = [...box.querySelectorAll('input, select')];
  for (const same of $('controls').querySelectorAll(`[data-key="${CSS.escape(box.dataset.key)}"]`)) {
    same.classList.add('changed');
    for (const [i, input] of [...same.querySelectorAll('input, select')].entries()) [input.value, input.checked] = [now[i].value, now[i].checked];
  }
}

function element(type, properties) {
  const made = document.createElement(type);
  Object.assign(made, properties);
  return made;
}

// A slider and a number that follow each other; a number alone where any is good. What is dragged waits for more to
// come for `wait_ms`.
function numberInputs(row, value, low, high, change, wait_ms = 0) {
  const step = row.type === 'whole number' ? 1 : 'any';
  const bounds = row.low < row.high ? {min: row.low, max: row.high} : {min: 0};
  const number = element('input', {type: 'number', ...bounds, step, value: Number(Number(value).toPrecision(6))});
  const slider = element('input', {type: 'range', min: low, max: high, step: step === 1 ? 1 : (high - low) / 400, value});
  let waiting = 0;
  slider.oninput = () => {
    number.value = Number(Number(slider.value).toPrecision(4));
    clearTimeout(waiting);
    waiting = setTimeout(() => change(Number(number.value)), wait_ms);
  };
  number.onchange = () => {
    if (!number.reportValidity() || number.value === '') return;
    clearTimeout(waiting);
    slider.value = number.value;
    change(Number(number.value));
  };
  return row.low < row.high ? [slider, number] : [number];
}

function addSetting(group, row) {
  const change = (value) => {
    changes.settings[row.key] = value;
    described.settings.find(({key}) => key === row.key).value = value;
    markChanged(box);
    tell({set: [row.key, value]});
    if (row.key === 'show') showView(value);
    remember();
  };
  let inputs;
  if (row.switch) {
    const check = element('input', {type: 'checkbox', checked: row.value !== 0});
    check.onchange = () => change(check.checked ? 1 : 0);
    inputs = [check];
  } else if (row.words?.length) {
    const select = element('select', {});
    for (const [i, word] of row.words.entries()) select.append(element('option', {value: row.low + i, textContent: word, selected: row.value === row.low + i}));
    select.onchange = () => change(Number(select.value));
    inputs = [select];
  } else {
    inputs = numberInputs(row, row.value, row.low, row.high, change);
  }
  const box = addRow(group, row, row.key, inputs);
  box.classList.toggle('changed', row.key in changes.settings);
}

// A slider that reaches from 0 to the bound would have most values in its first pixel.
function sliderBounds(row, value) {
  if (row.high - row.low <= 20 && row.high <= 10 && row.key !== 'length') return [row.low, row.high];
  const far = value === 0 ? Math.min(1, row.high) : 4 * Math.abs(value);
  return [Math.max(row.low, row.low < 0 ? -far : 0), Math.min(row.high, far)];
}

function addKey(group, layer, row, exactBounds) {
  const isThis = ([l, k, , s]) => l === layer.name && k === row.key && s === shownSetup;
  const change = (value) => {
    changes.keys = changes.keys.filter((changed) => !isThis(changed));
    changes.keys.push([layer.name, row.key, value, shownSetup]);
    layer.values[described.keys.findIndex(({key}) => key === row.key)] = value;
    markChanged(box);
    tell({key: changes.keys.at(-1)});
    remember();
  };
  let inputs;
  if (row.words) {
    const select = element('select', {});
    for (const word of row.words) select.append(element('option', {textContent: word, selected: row.value === `"${word}"`}));
    select.onchange = () => change(`"${select.value}"`);
    inputs = [select];
  } else if (row.type === 'true or false') {
    const check = element('input', {type: 'checkbox', checked: row.value === 'true'});
    check.onchange = () => change(String(check.checked));
    inputs = [check];
  } else if (row.type === 'colour') {
    const value = JSON.parse(row.value);  // "#rrggbb", or three shares
    const hex = Array.isArray(value) ? `#${value.map((v) => Math.round(255 * v).toString(16).padStart(2, '0')).join('')}` : value;
    const colour = element('input', {type: 'color', value: hex});
    colour.onchange = () => change(`"${colour.value}"`);
    inputs = [colour];
  } else if (row.value !== 'none' && Number.isFinite(Number(row.value))) {
    const [low, high] = exactBounds ? [row.low, row.high] : sliderBounds(row, Number(row.value));
    const whole = row.type === 'whole number';
    inputs = numberInputs(row, row.value, low, high, (value) => change(!whole && Number.isInteger(value) ? value.toFixed(1) : String(value)), 120);
  } else {
    return;  // maps and tables are the setup's own
  }
  const box = addRow(group, row, `${layer.name}.${row.key}`, inputs);
  box.classList.toggle('changed', changes.keys.some(isThis));
}

function find() {
  const text = $('find').value.trim().toLowerCase();
  for (const group of $('controls').children) {
    let any = false;
    for (const row of group.querySelectorAll('.row')) {
      row.hidden = text !== '' && !row.textContent.toLowerCase().includes(text);
      any ||= !row.hidden;
    }
    group.hidden = !any;
    if (text !== '') group.open = any;
  }
}
$('find').oninput = find;
