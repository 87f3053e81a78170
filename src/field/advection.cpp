#include "field/advection.hpp"

#include "kernels/weno5.hpp"

namespace eulastic {
namespace {

// Calls along(piece, direction) for pieces of a row and all directions. Before each call the rows ahead of that
// direction are prefetched piece by piece, so that the prefetches are finished when the next one begins.
template <int Dim, class Along>
EULASTIC_INLINE void in_pieces(const Segment &row, const RowsAhead &ahead, const Along &along) {
  constexpr int length = 64;
  for (Segment piece = row; piece.i_begin < row.i_end; piece.i_begin = piece.i_end) {
    piece.i_end = std::min(piece.i_begin + length, row.i_end);
    const int begin = piece.i_begin - row.i_begin;
    for (int d = 0; d < Dim; ++d) {
      ahead.prefetch_rows(d, begin, piece.i_end < row.i_end ? length : ahead.length - begin);
      along(piece, d);
    }
  }
}

template <int Dim>
EULASTIC_INLINE void advect_faces(const Segment &row, const Field &v, int a, const double *inverse_spacing,
                                  double epsilon, const RowsAhead &ahead, double *rate) {
  const ConstView q = v[a];
  in_pieces<Dim>(row, ahead, [&](const Segment &s, int d) EULASTIC_BODY {
    const double *face = v[d].row(s.j, s.k);
    const std::ptrdiff_t own = v[d].stride(d), back = -q.stride(a);
    const std::ptrdiff_t one = d < a ? own : back, other = d < a ? back : own;  // in the order of directions
    const auto add = [&](auto speed, double factor) EULASTIC_BODY {
      kernels::add_advection_rate(s, q, d, kernels::direction_order(d, Dim), speed, factor * inverse_spacing[d],
                                  epsilon, rate);
    };
    if (d == a)
      add([=](int i) EULASTIC_BODY { return face[i]; }, 1);
    else
      add([=](int i) EULASTIC_BODY { return kernels::sum4(face + i, one, other); }, 0.25);
  });
}

template <int Dim>
EULASTIC_INLINE void advect_centres(const Segment &row, const ConstView &q, const Field &v,
                                    const double *inverse_spacing, double epsilon, const RowsAhead &ahead,
                                    double *rate) {
  in_pieces<Dim>(row, ahead, [&](const Segment &s, int d) EULASTIC_BODY {
    const double *face = v[d].row(s.j, s.k);
    const std::ptrdiff_t up = v[d].stride(d);
    kernels::add_advection_rate(
        s, q, d, kernels::direction_order(d, Dim), [=](int i) EULASTIC_BODY { return face[i] + face[i + up]; },
        0.5 * inverse_spacing[d], epsilon, rate);
  });
}

EULASTIC_CLONES void advect_faces_2d(const Segment &s, const Field &v, int a, const double *h, double e,
                                     const RowsAhead &ahead, double *r) {
  advect_faces<2>(s, v, a, h, e, ahead, r);
}
EULASTIC_CLONES void advect_faces_3d(const Segment &s, const Field &v, int a, const double *h, double e,
                                     const RowsAhead &ahead, double *r) {
  advect_faces<3>(s, v, a, h, e, ahead, r);
}
EULASTIC_CLONES void advect_centres_2d(const Segment &s, const ConstView &q, const Field &v, const double *h, double e,
                                       const RowsAhead &ahead, double *r) {
  advect_centres<2>(s, q, v, h, e, ahead, r);
}
EULASTIC_CLONES void advect_centres_3d(const Segment &s, const ConstView &q, const Field &v, const double *h, double e,
                                       const RowsAhead &ahead, double *r) {
  advect_centres<3>(s, q, v, h, e, ahead, r);
}

}  // namespace

void face_advection_rate(const Segment &row, const Field &v, int a, const double *inverse_spacing, double epsilon,
                         const RowsAhead &ahead, double *rate) {
  (v.count() == 2 ? advect_faces_2d : advect_faces_3d)(row, v, a, inverse_spacing, epsilon, ahead, rate);
}

void centre_advection_rate(const Segment &row, ConstView q, const Field &v, const double *inverse_spacing,
                           double epsilon, const RowsAhead &ahead, double *rate) {
  (v.count() == 2 ? advect_centres_2d : advect_centres_3d)(row, q, v, inverse_spacing, epsilon, ahead, rate);
}

}  // namespace eulastic
