/* Draws a frame as text, from the front, with no more than what a draw says and its vertices' bytes
 * (jobs/DRAWING.md): written so that C and C++ take it. */
#ifndef OUTSIDE_DRAW_FRAME_H
#define OUTSIDE_DRAW_FRAME_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define COLUMNS 72
#define ROWS 36

typedef struct Canvas {
  float low[3], high[3]; /* what is looked at, m */
  uint32_t hits[ROWS][COLUMNS];
} Canvas;

static void LookAt(Canvas* canvas, const float low[3], const float high[3]) {
  memset(canvas, 0, sizeof *canvas);
  memcpy(canvas->low, low, sizeof canvas->low);
  memcpy(canvas->high, high, sizeof canvas->high);
}

static void DrawPoint(Canvas* canvas, const float at[3]) {
  const float x = (at[0] - canvas->low[0]) / (canvas->high[0] - canvas->low[0]);
  const float y = (canvas->high[1] - at[1]) / (canvas->high[1] - canvas->low[1]);
  if (x >= 0.0f && x < 1.0f && y >= 0.0f && y < 1.0f)
    ++canvas->hits[lroundf(floorf(y * ROWS))][lroundf(floorf(x * COLUMNS))];
}

/* Instances of 64 bytes: the four coefficients of a cubic, then what colours and widens it. */
static void DrawInstances(Canvas* canvas, const unsigned char* vertices, size_t count) {
  for (size_t i = 0; i < count; ++i) {
    float c[4][3], at[3];
    memcpy(c, vertices + 64 * i, sizeof c);
    for (float t = 0.0f; t <= 1.0f; t += 0.125f) {
      for (int axis = 0; axis < 3; ++axis)
        at[axis] = c[0][axis] + t * (c[1][axis] + t * (c[2][axis] + t * c[3][axis]));
      DrawPoint(canvas, at);
    }
  }
}

/* Vertices of 32 bytes, a position first. */
static void DrawRibbons(Canvas* canvas, const unsigned char* vertices, const uint32_t* indices,
                        size_t index_count) {
  for (size_t i = 0; i < index_count; ++i) {
    float at[3];
    memcpy(at, vertices + 32 * indices[i], sizeof at);
    DrawPoint(canvas, at);
  }
}

/* Vertices of 48 bytes at height h: at position + h groom + h^2 force, of three floats at bytes 0, 16
 * and 32. */
static void DrawShell(Canvas* canvas, const unsigned char* vertices, const uint32_t* indices,
                      size_t index_count, float h) {
  for (size_t i = 0; i < index_count; ++i) {
    float position[3], groom[3], force[3], at[3];
    memcpy(position, vertices + 48 * indices[i], sizeof position);
    memcpy(groom, vertices + 48 * indices[i] + 16, sizeof groom);
    memcpy(force, vertices + 48 * indices[i] + 32, sizeof force);
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = position[axis] + h * (groom[axis] + h * force[axis]);
    DrawPoint(canvas, at);
  }
}

/* A strip of two quads between two vertices, from the skin to the tips. */
static void DrawFin(Canvas* canvas, const unsigned char* vertices, uint32_t from, uint32_t to) {
  const uint32_t ends[2] = {from, to};
  for (float h = 0.0f; h <= 1.0f; h += 0.5f) DrawShell(canvas, vertices, ends, 2, h);
}

/* Prints the picture and returns how many places of it something was drawn to. */
static uint32_t ShowCanvas(const Canvas* canvas) {
  uint32_t drawn = 0;
  for (int row = 0; row < ROWS; ++row) {
    for (int column = 0; column < COLUMNS; ++column) {
      const uint32_t hits = canvas->hits[row][column];
      drawn += hits != 0;
      putchar(hits == 0 ? ' ' : hits < 4 ? '.' : hits < 16 ? 'o' : '#');
    }
    putchar('\n');
  }
  return drawn;
}

#endif
