#include "base/exact_sum.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace eulastic {
namespace {

constexpr std::uint64_t limb_mask = 0xffffffffu;

std::uint64_t bits_of(double value) noexcept {
  std::uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

}  // namespace

void Superaccumulator::add(double value) noexcept {
  const std::uint64_t bits = bits_of(value);
  const int biased = static_cast<int>(bits >> 52 & 0x7ff);
  if (biased == 0x7ff) {
    ++word_[limbs];
    return;
  }
  const std::uint64_t fraction = bits & 0xfffffffffffffu;
  const std::uint64_t mantissa = biased ? fraction | 1ull << 52 : fraction;
  const int position = biased ? biased - 1 : 0;  // value = mantissa 2^(position - 1074)
  const unsigned __int128 shifted = static_cast<unsigned __int128>(mantissa) << (position & 31);
  std::int64_t *limb = &word_[position >> 5];
  const std::int64_t sign = bits >> 63 ? -1 : 1;
  limb[0] += sign * static_cast<std::int64_t>(static_cast<std::uint64_t>(shifted) & limb_mask);
  limb[1] += sign * static_cast<std::int64_t>(static_cast<std::uint64_t>(shifted >> 32) & limb_mask);
  limb[2] += sign * static_cast<std::int64_t>(static_cast<std::uint64_t>(shifted >> 64));
}

// Adds with error-free transformations: a value below 2^E is split into h1 + h2 + h3, multiples of 2^(E-47), 2^(E-94)
// and 2^(E-141), of which 64 add up exactly. (x + m) - m with m = 1.5 2^(E+5) rounds x to a multiple of 2^(E-47).
void Superaccumulator::add(const double *values, int n) noexcept {
  constexpr int digits = 47, in_range[2] = {200, 1900};
  std::uint64_t largest = 0;
  for (int i = 0; i < n; ++i) largest = std::max(largest, bits_of(values[i]) << 1);
  const int biased = static_cast<int>(largest >> 53);
  const auto rounder = [&](int level) {
    const std::uint64_t bits = static_cast<std::uint64_t>(biased + 6 - level * digits) << 52 | 1ull << 51;
    double value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  };
  if (largest == 0) return;
  bool inexact = biased < in_range[0] || biased > in_range[1];  // also true for infinities and NaN
  double high = 0, middle = 0, low = 0;
  if (!inexact) {
    const double m1 = rounder(0), m2 = rounder(1), m3 = rounder(2);
#pragma omp simd reduction(+ : high, middle, low) reduction(| : inexact)
    for (int i = 0; i < n; ++i) {
      const double h1 = (values[i] + m1) - m1, r1 = values[i] - h1;
      const double h2 = (r1 + m2) - m2, r2 = r1 - h2;
      const double h3 = (r2 + m3) - m3;
      high += h1;
      middle += h2;
      low += h3;
      inexact |= r2 != h3;
    }
  }
  if (inexact) {
    for (int i = 0; i < n; ++i) add(values[i]);
  } else {
    for (const double sum : {high, middle, low}) add(sum);
  }
}

void Superaccumulator::add(const Superaccumulator &other) noexcept {
  for (int w = 0; w < words; ++w) word_[w] += other.word_[w];
}

double Superaccumulator::value() const noexcept {
  if (word_[limbs] != 0) return std::numeric_limits<double>::quiet_NaN();
  std::array<std::int64_t, limbs + 1> digit{};
  const auto carry = [&](std::int64_t sign) {
    std::int64_t c = 0;
    for (int l = 0; l < limbs; ++l) {
      const std::int64_t t = sign * word_[l] + c;
      digit[l] = t & static_cast<std::int64_t>(limb_mask);
      c = t >> 32;  // the shift rounds towards minus infinity
    }
    digit[limbs] = c;
    return c;
  };
  const double sign = carry(1) < 0 ? -1 : 1;
  if (sign < 0) carry(-1);
  int top = limbs;
  while (top > 0 && digit[top] == 0) --top;
  unsigned __int128 leading = 0;
  for (int l = top; l > top - 3; --l) leading = leading << 32 | static_cast<unsigned __int128>(l >= 0 ? digit[l] : 0);
  for (int l = top - 3; l >= 0; --l)
    if (digit[l]) {
      leading |= 1;  // a sticky bit, so that the conversion rounds correctly
      break;
    }
  return sign * std::ldexp(static_cast<double>(leading), 32 * (top - 2) - 1074);
}

double lane_sum(const double *values, int n, std::int64_t first) noexcept {
  double lane[8] = {};
  int i = 0;
  for (; i < n && ((first + i) & 7); ++i) lane[(first + i) & 7] += values[i];
  for (; i + 8 <= n; i += 8)
#pragma omp simd
    for (int l = 0; l < 8; ++l) lane[l] += values[i + l];
  for (int l = 0; i < n; ++i, ++l) lane[l] += values[i];
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

void ExactSums::clear() noexcept {
  std::fill(sums_.begin(), sums_.end(), Superaccumulator{});
  for (Buffer &w : buffers_) w.count = 0;
}

void ExactSums::flush(int s) noexcept {
  sums_[s].add(buffers_[s].value, buffers_[s].count);
  buffers_[s].count = 0;
}

void ExactSums::add_row(int s, const double *values, int n, std::int64_t first) noexcept {
  for (int i = 0; i < n;) {
    const int length = std::min<int>(n - i, block - index_in_block(first + i));
    add(s, lane_sum(values + i, length, first + i));
    i += length;
  }
}

void ExactSums::add(ExactSums &other) noexcept {
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    other.flush(static_cast<int>(s));
    sums_[s].add(other.sums_[s]);
  }
}

PetscErrorCode ExactSums::reduce(MPI_Comm comm, double *result) {
  static_assert(sizeof(Superaccumulator) == Superaccumulator::words * sizeof(std::int64_t), "plain words");
  PetscFunctionBeginUser;
  for (std::size_t s = 0; s < sums_.size(); ++s) flush(static_cast<int>(s));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums_.data(), static_cast<int>(sums_.size()) * Superaccumulator::words,
                             MPI_INT64_T, MPI_SUM, comm));
  for (std::size_t s = 0; s < sums_.size(); ++s) result[s] = sums_[s].value();
  clear();
  PetscFunctionReturn(0);
}

PetscErrorCode reduce_parts(MPI_Comm comm, std::vector<ExactSums> &parts, double *result) {
  PetscFunctionBeginUser;
  for (std::size_t part = 1; part < parts.size(); ++part) parts[0].add(parts[part]);
  PetscCall(parts[0].reduce(comm, result));
  PetscFunctionReturn(0);
}

PetscErrorCode reduce_maxima(MPI_Comm comm, const std::vector<std::vector<double>> &parts,
                             std::vector<double> *result) {
  PetscFunctionBeginUser;
  *result = parts[0];
  for (const std::vector<double> &part : parts)
    for (std::size_t n = 0; n < part.size(); ++n) (*result)[n] = std::max((*result)[n], part[n]);
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, result->data(), static_cast<int>(result->size()), MPI_DOUBLE, MPI_MAX, comm));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
