#include "field/exact_sum.hpp"

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

// SplitMix64's finaliser (Steele, Lea, Flood 2014).
std::uint64_t mix(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
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

double Superaccumulator::value() const noexcept {
  if (word_[limbs] != 0) return std::numeric_limits<double>::quiet_NaN();
  std::array<std::int64_t, limbs + 1> digit{};
  const auto carry = [&](std::int64_t sign) {
    std::int64_t c = 0;
    for (int l = 0; l < limbs; ++l) {
      const std::int64_t t = sign * word_[l] + c;
      digit[l] = t & static_cast<std::int64_t>(limb_mask);
      c = t >> 32;  // floor
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
      leading |= 1;  // sticky: the conversion then rounds correctly
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

void ExactSums::add_row(int s, const double *values, int n, std::int64_t first) noexcept {
  for (int i = 0; i < n;) {
    const int length = std::min<int>(n - i, block - static_cast<int>((first + i) % block));
    add(s, lane_sum(values + i, length, first + i));
    i += length;
  }
}

PetscErrorCode ExactSums::reduce(MPI_Comm comm, double *result) {
  static_assert(sizeof(Superaccumulator) == Superaccumulator::words * sizeof(std::int64_t), "plain words");
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums_.data(), static_cast<int>(sums_.size()) * Superaccumulator::words,
                             MPI_INT64_T, MPI_SUM, comm));
  for (std::size_t s = 0; s < sums_.size(); ++s) result[s] = sums_[s].value();
  clear();
  PetscFunctionReturn(0);
}

std::uint64_t hash_points(const Grid &grid, ConstView field, const std::array<bool, 3> &staggering,
                          std::uint64_t salt) {
  const Layout &own = grid.layout();
  std::uint64_t hash = 0;
  for (int k = 0; k < grid.points_end(2, staggering[2]); ++k)
    for (int j = 0; j < grid.points_end(1, staggering[1]); ++j) {
      const double *row = field.row(j, k);
      const std::uint64_t y = own.begin[1] + j, z = own.begin[2] + k;
      const std::uint64_t row_key = mix(salt ^ mix(y + (z << 32)));
      for (int i = 0; i < grid.points_end(0, staggering[0]); ++i)
        hash += mix(bits_of(row[i]) ^ mix(row_key + own.begin[0] + i));
    }
  return hash;
}

}  // namespace eulastic
