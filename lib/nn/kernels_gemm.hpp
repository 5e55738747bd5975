// The matrix product: B packed into panels that stay in the caches, tiles of C held in registers.
// Part of kernels_v*.cpp, which define the lanes.
#pragma once
#include "nn/kernels_math.hpp"

namespace rdm {
namespace {

constexpr int kPanel = kLanes * kTileVectors;
static_assert(kPackStep % kPanel == 0);
constexpr int32_t kInPlaceRows = 2;  // up to here B is not worth packing when its rows lie in order

inline int32_t less_of(int32_t a, int32_t b) {
  return a < b ? a : b;
}
inline size_t at(int32_t i) {
  return static_cast<size_t>(i);
}

// C[kRows][kVectors lanes] = or += the sum over k in order. kColumns: A's rows are contiguous in i.
template <int kRows, int kVectors, bool kColumns>
void tile(int32_t k, const float* a, size_t a_step, const float* b, size_t b_step, float* c, size_t c_row,
          bool add) {
  V sum[kRows][kVectors];
#pragma GCC unroll 8
  for (size_t i = 0; i < kRows; ++i)
#pragma GCC unroll 8
    for (size_t j = 0; j < kVectors; ++j) sum[i][j] = V{};
  if (add) {
    const float* from = c;
#pragma GCC unroll 8
    for (size_t i = 0; i < kRows; ++i, from += c_row)
#pragma GCC unroll 8
      for (size_t j = 0; j < kVectors; ++j) sum[i][j] = load(from + j * kLanes);
  }
  for (int32_t p = 0; p < k; ++p) {
    V row[kVectors];
#pragma GCC unroll 8
    for (size_t j = 0; j < kVectors; ++j) row[j] = load(b + j * kLanes);
#pragma GCC unroll 8
    for (size_t i = 0; i < kRows; ++i) {
      const V s = all(a[kColumns ? i : i * a_step]);
#pragma GCC unroll 8
      for (size_t j = 0; j < kVectors; ++j) sum[i][j] = fma(s, row[j], sum[i][j]);
    }
    a += kColumns ? a_step : 1;
    b += b_step;
  }
#pragma GCC unroll 8
  for (size_t i = 0; i < kRows; ++i, c += c_row)
#pragma GCC unroll 8
    for (size_t j = 0; j < kVectors; ++j) store(c + j * kLanes, sum[i][j]);
}

using Tile = void (*)(int32_t, const float*, size_t, const float*, size_t, float*, size_t, bool);

template <int kVectors, bool kColumns>
inline Tile tile_of_rows(int32_t rows) {
  switch (rows) {
    case 1:
      return tile<1, kVectors, kColumns>;
    case 2:
      return tile<2, kVectors, kColumns>;
    case 3:
      return tile<3, kVectors, kColumns>;
    case 4:
      return tile<4, kVectors, kColumns>;
    case 5:
      return tile<5, kVectors, kColumns>;
    default:
      return tile<6, kVectors, kColumns>;
  }
}

template <bool kColumns>
inline Tile tile_of(int32_t rows, int32_t vectors) {
  if constexpr (kTileVectors > 2) {
    if (vectors == 4) return tile_of_rows<4, kColumns>(rows);
    if (vectors == 3) return tile_of_rows<3, kColumns>(rows);
  }
  return vectors == 2 ? tile_of_rows<2, kColumns>(rows) : tile_of_rows<1, kColumns>(rows);
}

inline int32_t padded(int32_t n) {
  return (n + kLanes - 1) / kLanes * kLanes;
}

// B(k0.., j0..) into panels of kPanel columns, the last one as wide as whole lanes need, padded with zeros.
// Panel j of depth k begins at packed + j k.
void pack_rows(const float* b, size_t b_row, int32_t k, int32_t n, float* packed) {
  const int32_t whole = n / kPanel * kPanel, last = n - whole, wide = padded(last);
  for (int32_t p = 0; p < k; ++p, b += b_row) {
    for (int32_t j = 0; j < whole; j += kPanel)
#pragma GCC unroll 4
      for (size_t v = 0; v < kPanel; v += kLanes)
        store(packed + at(j) * at(k) + at(p) * kPanel + v, load(b + at(j) + v));
    float* to = packed + at(whole) * at(k) + at(p) * at(wide);
    for (int32_t j = 0; j < wide; j += kLanes)
      store(to + at(j), load_part(b + at(whole + j), less_of(kLanes, last - j)));
  }
}

void pack_columns(const float* b, size_t b_col, int32_t k, int32_t n, float* packed) {
  for (int32_t j0 = 0; j0 < n; j0 += kPanel) {
    const int32_t width = less_of(kPanel, n - j0), wide = padded(width);
    float* panel = packed + at(j0) * at(k);
    for (int32_t j = 0; j < wide; j += kBlock) {
      const float* from = b + at(j0 + j) * b_col;
      const int32_t live = width - j;
      int32_t p = 0;
      if (live >= kBlock)
        for (; p + kBlock <= k; p += kBlock) {
          Column column[kBlock];
          load_columns(from + p, b_col, column);
          for (int32_t q = 0; q < kBlock; ++q) store_column(panel + at(p + q) * at(wide) + at(j), column[q]);
        }
      for (; p < k; ++p)
        for (int32_t i = 0; i < kBlock; ++i)
          panel[at(p) * at(wide) + at(j + i)] = i < live ? from[at(i) * b_col + at(p)] : 0.0f;
    }
  }
}

// What follows the product, on rows that are still in the nearest cache.
inline V finish(const GemmArgs& g, V v, V bias, V h) {
  if (g.bias) v = v + bias;
  if (g.activate) v = activation_of(g.activation, v);
  if (g.slope_of) v = v * slope_of(g.activation, h);
  return v;
}

void finish_rows(const GemmArgs& g, int32_t i0, int32_t rows, int32_t j0, int32_t columns) {
  if (!g.bias && !g.activate && !g.slope_of) return;
  for (int32_t i = i0; i < i0 + rows; ++i) {
    float* c = g.c + at(i) * at(g.n);
    const float* h = g.slope_of ? g.slope_of + at(i) * at(g.n) : nullptr;
    int32_t j = j0;
    for (; j + kLanes <= j0 + columns; j += kLanes)
      store(c + j, finish(g, load(c + j), g.bias ? load(g.bias + j) : V{}, h ? load(h + j) : V{}));
    const int32_t left = j0 + columns - j;
    if (left > 0)
      store_part(c + j,
                 finish(g, load_part(c + j, left), g.bias ? load_part(g.bias + j, left) : V{},
                        h ? load_part(h + j, left) : V{}),
                 left);
  }
}

// All rows of C against one panel of B of depth k.
template <bool kColumns>
void panel_product(const GemmArgs& g, int32_t k0, int32_t k, const float* b, size_t b_step, int32_t j0,
                   int32_t columns, bool add, bool last) {
  const int32_t wide = padded(columns);
  for (int32_t i = 0; i < g.m; i += kTileRows) {
    const int32_t rows = less_of(kTileRows, g.m - i);
    const float* a = g.a + at(i) * g.a_row + at(k0) * g.a_col;
    const Tile product = tile_of<kColumns>(rows, wide / kLanes);
    float* c = g.c + at(i) * at(g.n) + at(j0);
    if (wide == columns) {
      product(k, a, kColumns ? g.a_col : g.a_row, b, b_step, c, at(g.n), add);
    } else {
      alignas(64) float edge[kTileRows * kPanel];
      if (add)
        for (int32_t r = 0; r < rows; ++r)
          std::memcpy(edge + r * wide, c + at(r) * at(g.n), at(columns) * sizeof(float));
      product(k, a, kColumns ? g.a_col : g.a_row, b, b_step, edge, at(wide), add);
      for (int32_t r = 0; r < rows; ++r)
        std::memcpy(c + at(r) * at(g.n), edge + r * wide, at(columns) * sizeof(float));
    }
    if (last) finish_rows(g, i, rows, j0, columns);
  }
}

// A few columns with rows of A and columns of B contiguous in k: lanes along k.
void dot_products(const GemmArgs& g) {
  for (int32_t i = 0; i < g.m; ++i)
    for (int32_t j = 0; j < g.n; ++j) {
      const float *a = g.a + at(i) * g.a_row, *b = g.b + at(j) * g.b_col;
      V sum[2] = {V{}, V{}};
      int32_t p = 0;
      for (; p + 2 * kLanes <= g.k; p += 2 * kLanes) {
        sum[0] = fma(load(a + p), load(b + p), sum[0]);
        sum[1] = fma(load(a + p + kLanes), load(b + p + kLanes), sum[1]);
      }
      for (; p < g.k; p += kLanes) {
        const int32_t n = less_of(kLanes, g.k - p);
        sum[0] = fma(load_part(a + p, n), load_part(b + p, n), sum[0]);
      }
      float& c = g.c[at(i) * at(g.n) + at(j)];
      c = sum_of(sum[0] + sum[1]) + (g.add ? c : 0.0f);
    }
  finish_rows(g, 0, g.m, 0, g.n);
}

// kBlocks blocks of columns of C for kRows rows: B is turned in registers, the order of the sums is a tile's.
template <int kRows, int kBlocks>
void turned_columns(const GemmArgs& g, int32_t i0, int32_t j0) {
  Column sum[kRows][kBlocks];
  float* const c = g.c + at(i0) * at(g.n) + at(j0);
  const float *const a = g.a + at(i0) * g.a_row, *const b = g.b + at(j0) * g.b_col;
#pragma GCC unroll 4
  for (size_t i = 0; i < kRows; ++i)
#pragma GCC unroll 4
    for (size_t j = 0; j < kBlocks; ++j)
      sum[i][j] = g.add ? load_column(c + i * at(g.n) + j * kBlock) : all_column(0.0f);
  int32_t p = 0;
  for (; p + kBlock <= g.k; p += kBlock)
#pragma GCC unroll 4
    for (size_t j = 0; j < kBlocks; ++j) {
      Column column[kBlock];
      load_columns(b + j * kBlock * g.b_col + at(p), g.b_col, column);
#pragma GCC unroll 4
      for (size_t i = 0; i < kRows; ++i)
#pragma GCC unroll 8
        for (size_t q = 0; q < kBlock; ++q)
          sum[i][j] = fma(all_column(a[i * g.a_row + at(p) + q]), column[q], sum[i][j]);
    }
  for (; p < g.k; ++p)
    for (size_t j = 0; j < kBlocks; ++j) {
      float column[kBlock];
      for (size_t q = 0; q < kBlock; ++q) column[q] = b[(j * kBlock + q) * g.b_col + at(p)];
      for (size_t i = 0; i < kRows; ++i)
        sum[i][j] = fma(all_column(a[i * g.a_row + at(p)]), load_column(column), sum[i][j]);
    }
#pragma GCC unroll 4
  for (size_t i = 0; i < kRows; ++i)
#pragma GCC unroll 4
    for (size_t j = 0; j < kBlocks; ++j) store_column(c + i * at(g.n) + j * kBlock, sum[i][j]);
}

template <int kRows>
void skinny_rows(const GemmArgs& g, int32_t i0) {
  int32_t j = 0;
  for (; j + 2 * kBlock <= g.n; j += 2 * kBlock) turned_columns<kRows, 2>(g, i0, j);
  for (; j + kBlock <= g.n; j += kBlock) turned_columns<kRows, 1>(g, i0, j);
  for (; j < g.n; ++j)
    for (int32_t i = i0; i < i0 + kRows; ++i) {
      float& c = g.c[at(i) * at(g.n) + at(j)];
      float sum = g.add ? c : 0.0f;
      for (int32_t p = 0; p < g.k; ++p)
        sum = fma(g.a[at(i) * g.a_row + at(p)], g.b[at(j) * g.b_col + at(p)], sum);
      c = sum;
    }
}

// A few rows, both A's rows and B's columns contiguous in k.
void skinny_product(const GemmArgs& g) {
  int32_t i = 0;
  for (; i + 4 <= g.m; i += 4) skinny_rows<4>(g, i);  // B is turned once for all of them
  for (; i + 2 <= g.m; i += 2) skinny_rows<2>(g, i);
  if (i < g.m) skinny_rows<1>(g, i);
  finish_rows(g, 0, g.m, 0, g.n);
}

template <bool kColumns>
void blocked_product(const GemmArgs& g) {
  const bool in_place = g.b_col == 1 && g.m <= kInPlaceRows;
  for (int32_t j0 = 0; j0 < g.n; j0 += g.pack_columns) {
    const int32_t n = less_of(g.pack_columns, g.n - j0);
    for (int32_t k0 = 0; k0 < g.k; k0 += kPackDepth) {
      const int32_t k = less_of(kPackDepth, g.k - k0);
      const bool add = g.add || k0 > 0, last = k0 + k == g.k;
      const float* b = g.b + at(k0) * g.b_row + at(j0) * g.b_col;
      if (g.b_col != 1 && !g.is_packed) pack_columns(b, g.b_col, k, n, g.packed);
      if (g.b_col == 1 && !in_place && !g.is_packed) pack_rows(b, g.b_row, k, n, g.packed);
      for (int32_t j = 0; j < n; j += kPanel) {
        const int32_t columns = less_of(kPanel, n - j);
        const bool whole = columns % kLanes == 0;
        const float* panel = g.packed + at(j) * at(k);
        if (in_place && !whole) pack_rows(b + j, g.b_row, k, columns, g.packed), panel = g.packed;
        if (in_place && whole)
          panel_product<kColumns>(g, k0, k, b + j, g.b_row, j0 + j, columns, add, last);
        else
          panel_product<kColumns>(g, k0, k, panel, at(padded(columns)), j0 + j, columns, add, last);
      }
    }
  }
}

void gemm(const GemmArgs& g) {
  if (g.n <= kDotColumns && g.a_col == 1 && g.b_row == 1)
    dot_products(g);
  else if (g.m <= kSkinnyRows && g.a_col == 1 && g.b_row == 1)
    skinny_product(g);
  else if (g.a_col == 1)
    blocked_product<false>(g);
  else
    blocked_product<true>(g);
}

}  // namespace
}  // namespace rdm
