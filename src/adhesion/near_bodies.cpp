#include "adhesion/near_bodies.hpp"

#include "base/send_to_ranks.hpp"
#include "grid/cell_ranks.hpp"

#include <algorithm>

namespace eulastic {
namespace {

// A body as it is sent to ranks that own cells of its hull.
struct Registered {
  BodyBlock body;
  int rank;
};

// The reply to the rank of a body; number 0: a surface is near.
struct Answer {
  int to;
  NearBody near;
};

// Returns whether two blocks intersect, across periodic boundaries too.
bool meet(const Domain &domain, const Extent &one, const Extent &other) {
  for (int d = 0; d < domain.dimension(); ++d) {
    const int low = other.begin[d] - one.begin[d];
    const int up = domain.is_wall(d) ? low : domain.image(d, low),
              down = domain.is_wall(d) ? -low : domain.image(d, -low);
    const bool above = up >= 0 && up < one.end[d] - one.begin[d];
    const bool below = down >= 0 && down < other.end[d] - other.begin[d];
    if (!above && !below) return false;
  }
  return true;
}

}  // namespace

PetscErrorCode find_surroundings(const Domain &domain, const std::vector<BodyBlock> &bodies,
                                 const std::function<bool(int, int)> &join,
                                 const std::function<bool(int, const Extent &)> &has_surface,
                                 std::map<int, Surroundings> *found) {
  std::vector<Registered> here;
  std::vector<Answer> answers;
  std::vector<int> to;
  PetscFunctionBeginUser;
  for (const BodyBlock &body : bodies)
    for (const int rank : ranks_over(domain, body.hull.begin, body.hull.end)) {
      here.push_back({body, domain.rank()});
      to.push_back(rank);
    }
  PetscCall(send_to_ranks(domain.comm(), to, &here));
  to.clear();
  const auto answer = [&](const Registered &one, const NearBody &near) {
    answers.push_back({one.body.number, near});
    to.push_back(one.rank);
  };
  for (std::size_t n = 0; n < here.size(); ++n) {
    const Registered &one = here[n];
    if (has_surface(one.body.species, one.body.hull)) answer(one, {});
    for (std::size_t m = 0; m < n; ++m) {
      const Registered &other = here[m];
      if (!join(one.body.species, other.body.species)) continue;
      if (!meet(domain, one.body.hull, other.body.box) && !meet(domain, one.body.box, other.body.hull)) continue;
      answer(one, {other.body.number, other.rank, other.body.box});
      answer(other, {one.body.number, one.rank, one.body.box});
    }
  }
  PetscCall(send_to_ranks(domain.comm(), to, &answers));
  std::sort(answers.begin(), answers.end(), [](const Answer &one, const Answer &other) {
    return std::pair(one.to, one.near.number) < std::pair(other.to, other.near.number);
  });
  found->clear();
  for (const Answer &of : answers) {
    Surroundings &around = (*found)[of.to];
    if (of.near.number == 0)
      around.surface = true;
    else if (around.bodies.empty() || around.bodies.back().number != of.near.number)  // several ranks reply the same
      around.bodies.push_back(of.near);
  }
  PetscFunctionReturn(0);
}

}  // namespace eulastic
