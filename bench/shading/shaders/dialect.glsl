// Before all other files: what makes one text of the two languages that read it, GLSL 3.30 core and ES 3.00, whose
// version line the host puts, and C++ (shading.hpp). Behind it comes jobs/shaders/fur_vertex.glsl.
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp sampler2DArray;
precision highp usampler2D;

#define CONST const
#define FN
// Of a function that looks up a tile of hairs, which is its first argument, and a height of it.
#define FN_OF_TILE
#define TILE sampler2D
#define TILE_HEIGHT(tile, place) textureLod(tile, place, 0.0).r
