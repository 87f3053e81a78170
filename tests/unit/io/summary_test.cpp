// summary.json can be read and has every key.
#include "io/summary.hpp"
#include "io/json.hpp"
#include "io/text_file.hpp"
#include "support/files.hpp"

#include <cmath>
#include <map>

namespace eulastic {
namespace {

using namespace test;

// Reads JSON strictly: keys with their path ("bodies.0.id") and the text of every value.
class JsonReader {
public:
  explicit JsonReader(const std::string &text) : text_(text) {
    value("");
    space();
    fine_ = fine_ && at_ == text_.size();
  }
  bool fine() const { return fine_; }
  const std::vector<std::string> &keys() const { return keys_; }
  std::string operator[](const std::string &key) const { return values_.count(key) ? values_.at(key) : "missing"; }

private:
  void space() { at_ = std::min(text_.find_first_not_of(" \n", at_), text_.size()); }
  bool take(char c) {
    space();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string string() {
    std::string result;
    if (!take('"')) fine_ = false;
    while (fine_ && at_ < text_.size() && text_[at_] != '"') {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) fine_ = false;
      if (text_[at_] == '\\') result += text_[at_++];
      result += text_[at_++];
    }
    fine_ = fine_ && take('"');
    return result;
  }
  void value(const std::string &path) {
    if (!fine_) return;
    const auto child = [&](const std::string &name) { return path.empty() ? name : path + "." + name; };
    if (take('{')) {
      if (take('}')) return;
      do {
        const std::string key = child(string());
        fine_ = fine_ && take(':');
        keys_.push_back(key);
        value(key);
      } while (fine_ && take(','));
      fine_ = fine_ && take('}');
    } else if (take('[')) {
      if (take(']')) return;
      int n = 0;
      do value(child(std::to_string(n++)));
      while (fine_ && take(','));
      fine_ = fine_ && take(']');
    } else if (space(), at_ < text_.size() && text_[at_] == '"') {
      values_[path] = string();
    } else {
      const std::size_t end = std::min(text_.find_first_of(",]} \n", at_), text_.size());
      const std::string word = text_.substr(at_, end - at_);
      char *rest = nullptr;
      if (word != "null") (void)std::strtod(word.c_str(), &rest);
      fine_ = word == "null" || (!word.empty() && *rest == 0 && word.find_first_not_of("-+.e0123456789") == word.npos);
      values_[path] = word;
      at_ = end;
    }
  }

  std::string text_;
  std::size_t at_ = 0;
  bool fine_ = true;
  std::vector<std::string> keys_;
  std::map<std::string, std::string> values_;
};

TEST(Json, WhatItWritesCanBeRead) {
  const JsonReader json(Json()
                            .add("text", std::string("a \"quoted\" \\ back\nslash"))
                            .add("third", 1.0 / 3)
                            .add("nan", std::nan(""))
                            .add("vector", Real3{1, -INFINITY, 1e-7})
                            .add("none", std::vector<Json>{})
                            .add("list", std::vector<Json>{Json().add("n", 1L), Json().add("n", -2L), Json()})
                            .text());
  EXPECT_TRUE(json.fine());
  EXPECT_EQ(json["text"], "a \\\"quoted\\\" \\\\ back\\u000aslash");
  EXPECT_EQ(json["third"], "0.33333333333333331");
  EXPECT_EQ(json["nan"], "null");
  EXPECT_EQ(json["vector.1"], "null");
  EXPECT_EQ(json["vector.2"], "9.9999999999999995e-08");
  EXPECT_EQ(json["list.1.n"], "-2");
  for (const char *broken : {"{", "{\"a\": nan}", "{\"a\": 1,}", "{\"a\" 1}", "{\"a\": 1}}", "{\"a\": [1 2]}"})
    EXPECT_FALSE(JsonReader(broken).fine()) << broken;
}

TEST(Summary, HasEveryKey) {
  const TemporaryDirectory base;
  Summary summary;
  summary.method = "classic";
  summary.cells = 4096;
  summary.steps = 10;
  summary.wall_seconds = 2;
  summary.state_hash = 0xfedcba9876543210u;
  summary.divergence_max = std::nan("");
  summary.files = {{"vessel_voxels", "my \"best\" vessel.stl", "0123456789abcdef"}};
  summary.sides = {{"xmin", 2.5, 0.25}};
  summary.verdicts = {{"energy", "look", "why"}};
  summary.bodies = {{1, "rbc", {1, 2, 3}, {4, 5, 6}, 7, 0.5, -45}, {2, "rbc", {}, {}, 0, 0, 0}};
  ASSERT_EQ(write_summary(PETSC_COMM_SELF, base / "summary.json", summary), 0);
  const JsonReader json(text_of(base / "summary.json"));
  ASSERT_TRUE(json.fine());
  const std::vector<std::string> expected{"version",
                                          "method",
                                          "pressure_solver",
                                          "exit_reason",
                                          "checkpoint",
                                          "cells",
                                          "ranks",
                                          "threads",
                                          "steps",
                                          "time",
                                          "dt_mean",
                                          "wall_seconds",
                                          "wall_seconds_total",
                                          "cell_updates_per_second",
                                          "ns_per_cell_step",
                                          "bytes_per_cell",
                                          "active_fraction",
                                          "acm_sweeps_per_step",
                                          "ksp_iterations_per_step",
                                          "viscous_stages_per_step",
                                          "strain_forgotten",
                                          "divergence_rms",
                                          "divergence_max",
                                          "mach_max",
                                          "volume_drift",
                                          "kinetic_energy",
                                          "elastic_energy",
                                          "viscous_dissipation",
                                          "force_power",
                                          "wall_power",
                                          "elastic_power",
                                          "energy_supplied",
                                          "energy_dissipated",
                                          "energy_lost",
                                          "energy_lost_elastic",
                                          "energy_lost_extended",
                                          "energy_made_share",
                                          "surface_energy",
                                          "surface_power",
                                          "side_power",
                                          "files",
                                          "files.0.option",
                                          "files.0.path",
                                          "files.0.content",
                                          "sides",
                                          "sides.0.side",
                                          "sides.0.flow_rate",
                                          "sides.0.pressure",
                                          "verdicts",
                                          "verdicts.0.of",
                                          "verdicts.0.verdict",
                                          "verdicts.0.why",
                                          "bulk_velocity",
                                          "state_hash",
                                          "bodies",
                                          "bodies.0.id",
                                          "bodies.0.species",
                                          "bodies.0.centroid",
                                          "bodies.0.velocity",
                                          "bodies.0.volume",
                                          "bodies.0.taylor_deformation",
                                          "bodies.0.inclination",
                                          "bodies.0.elastic_energy",
                                          "bodies.0.largest_stretch",
                                          "bodies.0.rest_deformation"};
  ASSERT_GE(json.keys().size(), expected.size());
  for (std::size_t n = 0; n < expected.size(); ++n) EXPECT_EQ(json.keys()[n], expected[n]);
  EXPECT_EQ(json["cell_updates_per_second"], "20480");
  EXPECT_EQ(json["ns_per_cell_step"], format_double(2e9 / 40960));
  EXPECT_EQ(json["state_hash"], "fedcba9876543210");
  EXPECT_EQ(json["divergence_max"], "null");
  EXPECT_EQ(json["bodies.0.centroid.2"], "3");
  EXPECT_EQ(json["bodies.1.id"], "2");
  const JsonReader nothing(summary_text({}));  // no steps: rates are 0/0
  EXPECT_TRUE(nothing.fine());
  EXPECT_EQ(nothing["ns_per_cell_step"], "null");
}

}  // namespace
}  // namespace eulastic
