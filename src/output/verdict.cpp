#include "output/verdict.hpp"

#include "base/one_line.hpp"
#include "scene/red_cell.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr const char *fine = "fine", *look = "look", *do_not_trust = "do not trust";

// Shares of what the energies are compared with.
constexpr double rows_to_look = 0.1, made_to_look = 0.02, lost_to_look = 0.05, energy_not_to_trust = 0.3;
// Relative changes of a body's volume, and of the area of a red cell's membrane, which bursts at 4 %.
constexpr double volume_to_look = 0.01, volume_not_to_trust = 0.05;
constexpr double area_to_look = red_cell_bursts, area_not_to_trust = 0.1;
// Shares of the points at which B was evolved.
constexpr double forgotten_not_to_trust = 1e-3;

const char *word(double value, double to_look, double not_to_trust) {
  return value > not_to_trust || value != value ? do_not_trust : value > to_look ? look : fine;
}

std::string percent(double share) { return print("%.2g %%", 100 * share); }

double over(double a, double b) { return b > 0 ? a / b : 0; }

}  // namespace

Verdict judge_energy(const Evidence &e) {
  const std::string of = "energy", all = " of the energy that it held and was supplied with";
  const double made = e.budget.generated_share_max(), lost = over(e.budget.lost(), e.budget.throughput()),
               uncertainty = over(e.budget.uncertainty(), e.budget.throughput());
  if (!e.energy_unknown.empty()) return {of, look, e.energy_unknown};
  if (made > made_to_look || made != made)
    return {of, word(made, made_to_look, energy_not_to_trust),
            "the numerics generated energy, " + percent(made) + all + " meanwhile"};
  if (lost - uncertainty > lost_to_look || lost != lost)
    return {of, word(lost - uncertainty, lost_to_look, energy_not_to_trust),
            "the numerics lost " + percent(lost) + all};
  if (uncertainty > rows_to_look)
    return {of, look,
            "rows of series.csv are too far apart to tell within " + percent(uncertainty) + all +
                "; use a shorter -series_interval"};
  return {of, fine,
          "the numerics " + (lost < 0 ? "made " + percent(-lost) : "lost " + percent(lost)) + all +
              (uncertainty > 0.01 ? ", known within " + percent(uncertainty) : "")};
}

Verdict judge_volume_and_area(const Config &config, const Evidence &e) {
  const std::string of = "volume and area";
  if (const std::vector<std::string> coarse = coarse_drop_warnings(config); !coarse.empty())
    return {of, do_not_trust, coarse.front()};
  const Measured &m = e.measured;
  const std::string volume = word(m.volume_drift, volume_to_look, volume_not_to_trust),
                    area = word(m.red_cell_area.value, area_to_look, area_not_to_trust);
  const std::string why = "the volume of a body has changed by " + percent(m.volume_drift) + " at most",
                    of_area = "the area of a red cell has grown by " + percent(std::max(m.red_cell_area.value, 0.0));
  const bool red_cells = m.red_cell_area.label > 0;
  if (volume == do_not_trust || (volume == look && area != do_not_trust)) return {of, volume, why};
  if (red_cells && area != fine) return {of, area, of_area};
  return {of, fine, red_cells ? why + ", " + of_area + " at most" : why};
}

Verdict judge_strain(const Evidence &e) {
  if (e.forgotten == 0) return {"strain", fine, "the grid resolved it everywhere"};
  const double share = over(e.forgotten, e.evolved);
  return {"strain", share > forgotten_not_to_trust ? do_not_trust : look,
          "the grid did not resolve it at " + percent(share) + " of the points, where a part of it was lost"};
}

std::string verdict_line(const Verdict &v) { return v.of + ": " + v.verdict + " (" + v.why + ")"; }

}  // namespace eulastic
