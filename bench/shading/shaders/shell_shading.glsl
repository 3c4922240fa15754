// What a renderer of shells works out for a vertex and a sample (jobs/DRAWING.md, core/chunk.hpp).
// Shells are lit as hair is, strand_light.glsl: along ShellDirection, with a shell's `shadow` as the
// light that the coat leaves at its depth.

// Which way the hairs at a vertex go at a height, unit.
FN vec3 ShellDirection(vec3 groom, vec3 force, float height) {
  vec3 along = ShellSlope(groom, force, height);
  return along / max(length(along), 1e-9f);
}

// Whether a hair of this length, of the longest, where this share of the fur stands, reaches past the
// shell's threshold: 1, or 0.
FN float ShellCoverage(float hair, float stencil, float threshold) {
  return hair * stencil > threshold ? 1.0f : 0.0f;
}

// A fin, an edge of the skin drawn out along its hairs, is a strip of kFinSteps quads that follow their bend. Its ends
// are at ShellPosition; a hair at a share of the edge covers it up to its height, by ShellCoverage with the height as
// threshold.
CONST uint kFinSteps = 4u;

FN float FinHeight(uint at) { return float(at) / float(kFinSteps); }
