#include "options/option_rows.hpp"

namespace eulastic {
namespace {

void add_region(Rows &rows, AdhesiveRegion &area) {
  Option &region = rows.add("region", "length",
                            "box in which a wall, or the surface of a rigid or anchored species, is adhesive: x,y,z of "
                            "its low corner, then of its high corner");
  region.accepted = several(6, "number", any_number);
  region.default_note = "everywhere";
  region.read = [&area](const std::string &value) {
    double corners[6];
    std::string wrong = read_numbers(value, any_number, corners, 6);
    for (int d = 0; d < 3 && wrong.empty(); ++d) {
      area.low[d] = corners[d];
      area.high[d] = corners[3 + d];
      if (!(area.low[d] <= area.high[d])) wrong = "the low corner must be below the high one";
    }
    return wrong;
  };
  region.text = [&area] {
    if (area.low[0] == -HUGE_VAL) return std::string();
    Names items;
    for (const Real3 *corner : {&area.low, &area.high})
      for (const double place : *corner) items.push_back(to_text(place));
    return join(items, ",");
  };
  Option &file = rows.path("region_file", area.file.path,
                           "file (HDF5, NRRD, STL) of a volume; a wall or surface is adhesive in the cells that this "
                           "volume fills at least in part, and with -adhesion_NAME1_NAME2_region only inside that box");
  file.accepted = "a path, of HDF5 also FILE:DATASET";
  file.names_file = any_file;
}

}  // namespace

std::string read_adhesion(const std::string &value, Config *config) {
  Names words;
  std::string wrong = read_words(value, {}, &words);
  for (const std::string &word : words) {
    const std::size_t dash = word.find('-');
    const std::string names[2] = {word.substr(0, dash), dash == std::string::npos ? "" : word.substr(dash + 1)};
    int found[2] = {-2, -2};
    for (int n = 0; n < 2; ++n) {
      if (n == 1 && names[n] == "wall") found[n] = AdhesionPair::wall;
      for (std::size_t s = 0; s < config->species.size(); ++s)
        if (config->species[s].name == names[n]) found[n] = static_cast<int>(s);
    }
    if (found[0] < 0 || found[1] == -2) return "\"" + word + "\" is no pair of species, or of a species and wall";
    for (const AdhesionPair &pair : config->adhesion.pairs)
      if ((pair.first == found[0] && pair.second == found[1]) || (pair.first == found[1] && pair.second == found[0]))
        return "\"" + word + "\" is named twice";
    AdhesionPair &pair = config->adhesion.pairs.emplace_back();
    pair.name = word;
    pair.first = found[0];
    pair.second = found[1];
  }
  return wrong;
}

void add_adhesion(Rows &rows, Config &config) {
  rows.group = "Adhesion";
  Option &pairs = rows.add("adhesion", "",
                           "pairs of surfaces that adhere by bonds; each has its own set of the options "
                           "-adhesion_NAME1_NAME2_...; none: no adhesion");
  pairs.accepted = "a list without spaces of NAME1-NAME2, two species or the same one twice, or NAME-wall";
  pairs.default_note = "none";
  pairs.read = [](const std::string &) { return std::string(); };  // read before this table, which it lengthens
  pairs.text = [&config] {
    Names names;
    for (const AdhesionPair &pair : config.adhesion.pairs) names.push_back(pair.name);
    return join(names, ",");
  };
  rows.limit("-adhesion", [&config] { return !config.adhesion.pairs.empty(); });
  rows.integer("adhesion_seed", config.adhesion.seed, {0, false, 4294967295.},
               "seed of the random numbers by which bonds form and break");
  rows.end_limit();
  for (AdhesionPair &pair : config.adhesion.pairs) {
    rows.group = "Adhesion " + pair.name;
    std::string name = pair.name;
    name[name.find('-')] = '_';
    rows.prefix = "adhesion_" + name + "_";
    kernels::BondLaw &law = pair.law;
    rows.real("density", pair.density, positive, "1/area",
              "number of receptors per area on the surfaces of the bodies; in 2-D per length")
        .required = true;
    rows.real("reach", law.reach, positive, "length",
              "largest distance from the other surface at which a free receptor binds")
        .required = true;
    rows.real("rate_on", law.rate_on, not_negative, "1/time", "rate at which a free receptor within reach forms a bond")
        .required = true;
    rows.real("rate_off", law.rate_off, not_negative, "1/time", "rate at which a bond without tension breaks")
        .required = true;
    rows.real("bond_stiffness", law.stiffness, positive, "force/length", "spring constant of a bond").required = true;
    rows.real("bond_length", law.length, not_negative, "length", "length of a bond at which its tension is 0");
    rows.real("reactive_compliance", law.reactive_compliance, not_negative, "1/force",
              "reactive compliance x/kT of Bell's law: the tension F multiplies the rate of rupture by exp(F x/kT); 0: "
              "tension has no effect");
    rows.real("catch_rate_off", law.catch_rate_off, not_negative, "1/time",
              "rate of rupture, without tension, along a second path that tension suppresses (catch bonds); 0: no "
              "second path");
    rows.real("catch_compliance", law.catch_compliance, not_negative, "1/force",
              "compliance c of this second path: the tension F multiplies its rate by exp(-F c)");
    rows.real("thermal_energy", law.thermal_energy, not_negative, "energy",
              "thermal energy kT, by which stretched bonds form at a lower rate, in detailed balance; 0: the rate is "
              "the same everywhere within reach");
    add_region(rows, pair.region);
    rows.prefix.clear();
  }
}

}  // namespace eulastic
