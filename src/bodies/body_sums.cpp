#include "bodies/body_sums.hpp"

#include <cmath>

namespace eulastic {
namespace {

constexpr int fixed_bits = 48;
constexpr int low_bits = 40;

}  // namespace

void BodySums::add(const BodySums &other) noexcept {
  for (std::size_t s = 0; s < sums_.size(); ++s) sums_[s] += other.sums_[s];
}

PetscErrorCode BodySums::reduce(MPI_Comm comm) {
  PetscFunctionBeginUser;
  std::vector<std::int64_t> words(2 * sums_.size());
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    words[2 * s] = static_cast<std::int64_t>(sums_[s] >> low_bits);  // floor
    words[2 * s + 1] = static_cast<std::int64_t>(sums_[s] & ((std::int64_t{1} << low_bits) - 1));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, words.data(), static_cast<int>(words.size()), MPI_INT64_T, MPI_SUM, comm));
  for (std::size_t s = 0; s < sums_.size(); ++s)
    sums_[s] = static_cast<__int128>(words[2 * s]) * (std::int64_t{1} << low_bits) + words[2 * s + 1];
  PetscFunctionReturn(0);
}

double BodySums::value(int body, int s) const noexcept {
  return std::ldexp(static_cast<double>(sums_[std::size_t(body) * per_body_ + s]), -fixed_bits);
}

}  // namespace eulastic
