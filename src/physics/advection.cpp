#include "physics/advection.hpp"

#include "kernels/weno5.hpp"

namespace eulastic {
namespace {

using kernels::Batch, kernels::Turn, kernels::add_advection_rate;

// One direction, carried by the mean of one, two or four faces, or by slots.
struct Along {
  Turn turn;
  std::ptrdiff_t stride;
  double inverse_spacing, epsilon;
};

EULASTIC_CLONES void by_one(const Segment &s, const ConstView &q, const Along &d, const double *face, double *rate) {
  add_advection_rate(
      s, q, d.turn, d.stride, [=](int i) EULASTIC_BODY { return face[i]; }, d.inverse_spacing, d.epsilon, rate);
}
EULASTIC_CLONES void by_two(const Segment &s, const ConstView &q, const Along &d, const double *face, std::ptrdiff_t up,
                            double *rate) {
  add_advection_rate(
      s, q, d.turn, d.stride, [=](int i) EULASTIC_BODY { return 0.5 * (face[i] + face[i + up]); }, d.inverse_spacing,
      d.epsilon, rate);
}
EULASTIC_CLONES void by_four(const Segment &s, const ConstView &q, const Along &d, const double *face,
                             std::ptrdiff_t one, std::ptrdiff_t other, double *rate) {
  add_advection_rate(
      s, q, d.turn, d.stride, [=](int i) EULASTIC_BODY { return kernels::average4(face + i, one, other); },
      d.inverse_spacing, d.epsilon, rate);
}
struct Everywhere {
  const double *velocity[3];
  double inverse_spacing[3], epsilon;
};

template <int Dim>
EULASTIC_INLINE void by_slots(const Batch &batch, const ConstView &view, const Everywhere &e, double *rate) {
  const double *u = e.velocity[0], *v = e.velocity[1], *w = e.velocity[Dim == 3 ? 2 : 0], *origin = view.origin;
  const double ix = e.inverse_spacing[0], iy = e.inverse_spacing[1], iz = e.inverse_spacing[2], epsilon = e.epsilon;
  const std::ptrdiff_t sy = view.sy, sz = view.sz;
  kernels::for_points(batch, view, [=](std::ptrdiff_t o, int i) EULASTIC_BODY {
    const double *q = origin + o;
    double sum = u[i] * ix * kernels::weno5_difference(q, 1, u[i], epsilon);
    sum = kernels::fma(v[i] * iy, kernels::weno5_difference(q, sy, v[i], epsilon), sum);
    if constexpr (Dim == 3) sum = kernels::fma(w[i] * iz, kernels::weno5_difference(q, sz, w[i], epsilon), sum);
    rate[i] = -sum;
  });
}
EULASTIC_CLONES void by_slots_2d(const Batch &batch, const ConstView &q, const Everywhere &e, double *rate) {
  by_slots<2>(batch, q, e, rate);
}
EULASTIC_CLONES void by_slots_3d(const Batch &batch, const ConstView &q, const Everywhere &e, double *rate) {
  by_slots<3>(batch, q, e, rate);
}

Along along(ConstView q, int d, int dimension, const double *inverse_spacing, double epsilon) {
  const Turn turn = d == 0 ? Turn::first : d < dimension - 1 ? Turn::between : Turn::last;
  return {turn, q.stride(d), inverse_spacing[d], epsilon};
}

}  // namespace

void face_advection_rate(const Segment &s, const FieldBlock &v, int a, const double *inverse_spacing, double epsilon,
                         double *rate) {
  const ConstView q = v[a];
  for (int d = 0; d < v.count(); ++d) {
    const Along direction = along(q, d, v.count(), inverse_spacing, epsilon);
    const double *face = v[d].row(s.j, s.k);
    const std::ptrdiff_t own = v[d].stride(d), back = -q.stride(a);
    if (d == a)
      by_one(s, q, direction, face, rate);
    else  // averaged in the order of directions
      by_four(s, q, direction, face, d < a ? own : back, d < a ? back : own, rate);
  }
}

void centre_advection_rate(const Segment &s, ConstView q, const FieldBlock &v, const double *inverse_spacing,
                           double epsilon, double *rate) {
  for (int d = 0; d < v.count(); ++d)
    by_two(s, q, along(q, d, v.count(), inverse_spacing, epsilon), v[d].row(s.j, s.k), v[d].stride(d), rate);
}

void advection_rate(const Batch &batch, ConstView q, int dimension, const double *const *velocity,
                    const double *inverse_spacing, double epsilon, double *rate) {
  const Everywhere e{{velocity[0], velocity[1], velocity[dimension - 1]},
                     {inverse_spacing[0], inverse_spacing[1], inverse_spacing[2]},
                     epsilon};
  (dimension == 2 ? by_slots_2d : by_slots_3d)(batch, q, e, rate);
}

}  // namespace eulastic
