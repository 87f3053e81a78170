#include "boxes/share_out.hpp"

#include "base/send_to_ranks.hpp"

#include <algorithm>
#include <map>

namespace eulastic {
namespace {

// What the home of a body hears of it, and answers.
struct Asked {
  int number, owner, target;
  double cost;
};

}  // namespace

double water_level(std::vector<double> heights, double total) {
  std::sort(heights.begin(), heights.end());
  double below = 0;  // what bowls take up to the next height
  for (std::size_t n = 1; n < heights.size(); ++n) {
    const double more = double(n) * (heights[n] - heights[n - 1]);
    if (below + more >= total) return heights[n - 1] + (total - below) / double(n);
    below += more;
  }
  return heights.back() + (total - below) / double(heights.size());
}

double phase_work(const Material &material, bool in_box) {
  if (material.is_rigid()) return 0;
  if (material.is_membrane()) return 5;
  return in_box ? 4 : 3;
}

std::vector<int> fill_ranks(const std::vector<double> &loads, double before, double total,
                            const std::vector<double> &costs) {
  const double level = water_level(loads, total);
  std::vector<double> ends;  // of what ranks take, one after the other
  for (const double height : loads) ends.push_back((ends.empty() ? 0 : ends.back()) + std::max(0.0, level - height));
  std::vector<int> ranks;
  for (const double cost : costs) {
    const auto taker = std::upper_bound(ends.begin(), ends.end(), before + 0.5 * cost);
    ranks.push_back(static_cast<int>(std::min(taker, ends.end() - 1) - ends.begin()));
    before += cost;
  }
  return ranks;
}

PetscErrorCode share_out(MPI_Comm comm, double load, const std::vector<BodyShare> &bodies, std::vector<int> *ranks) {
  int rank, size;
  std::vector<Asked> asked;
  std::vector<int> to;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  for (const BodyShare &body : bodies) {
    asked.push_back({body.number, rank, 0, body.cost});
    to.push_back(body.home);
  }
  PetscCall(send_to_ranks(comm, to, &asked));
  std::sort(asked.begin(), asked.end(), [](const Asked &one, const Asked &other) { return one.number < other.number; });
  double own[2] = {load, 0};
  for (const Asked &body : asked) own[1] += body.cost;
  std::vector<double> all(2 * static_cast<std::size_t>(size)), loads;
  PetscCallMPI(MPI_Allgather(own, 2, MPI_DOUBLE, all.data(), 2, MPI_DOUBLE, comm));
  double before = 0, total = 0;  // costs of bodies at home on earlier ranks, on all
  for (int r = 0; r < size; ++r) {
    loads.push_back(all[2 * r]);
    if (r < rank) before += all[2 * r + 1];
    total += all[2 * r + 1];
  }
  std::vector<double> costs;
  for (const Asked &body : asked) costs.push_back(body.cost);
  const std::vector<int> takers = fill_ranks(loads, before, total, costs);
  to.clear();
  for (std::size_t n = 0; n < asked.size(); ++n) {
    asked[n].target = takers[n];
    to.push_back(asked[n].owner);
  }
  PetscCall(send_to_ranks(comm, to, &asked));
  std::map<int, int> targets;
  for (const Asked &body : asked) targets[body.number] = body.target;
  ranks->clear();
  for (const BodyShare &body : bodies) ranks->push_back(targets.at(body.number));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
