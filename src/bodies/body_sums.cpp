#include "bodies/body_sums.hpp"

namespace eulastic {
namespace {

constexpr int fixed_bits = 48;
// A sum is sent as three integers in doubles; summed over 2^19 ranks they stay below 2^53 and therefore exact.
constexpr int words = 3, word_bits = 34;

}  // namespace

void BodySums::add(const BodySums &other) noexcept {
  for (std::size_t s = 0; s < sums_.size(); ++s) sums_[s] += other.sums_[s];
}

PetscErrorCode BodySums::reduce(const BodyOwners &owners) {
  constexpr std::int64_t mask = (std::int64_t{1} << word_bits) - 1;
  PetscFunctionBeginUser;
  std::vector<double> here(words * sums_.size());
  std::vector<double> owned(words * static_cast<std::size_t>(owners.owned().size()) * per_body_, 0.0);
  for (std::size_t s = 0; s < sums_.size(); ++s)
    for (int w = 0; w < words; ++w) {
      const auto part = static_cast<std::int64_t>(sums_[s] >> (w * word_bits));  // floor
      here[words * s + w] = static_cast<double>(w == words - 1 ? part : part & mask);
    }
  PetscCall(owners.reduce(words * per_body_, MPI_SUM, here, &owned));
  sums_.resize(owned.size() / words);
  for (std::size_t s = 0; s < sums_.size(); ++s) {
    sums_[s] = 0;
    for (int w = words - 1; w >= 0; --w)
      sums_[s] = sums_[s] * (std::int64_t{1} << word_bits) + static_cast<std::int64_t>(owned[words * s + w]);
  }
  PetscFunctionReturn(0);
}

double BodySums::value(int body, int s) const noexcept {
  return std::ldexp(static_cast<double>(sums_[std::size_t(body) * per_body_ + s]), -fixed_bits);
}

}  // namespace eulastic
