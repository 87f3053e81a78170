// Spans of rows: they are wide enough, empty elsewhere, and right again after the field has moved.
#include "grid/occupied_rows.hpp"
#include "field/field.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

using namespace eulastic;

namespace {

struct Scene {
  explicit Scene(bool flat) {
    GridSpec spec;
    spec.cells = {48, 40, flat ? 1 : 40};
    EXPECT_EQ(domain.create(PETSC_COMM_SELF, spec), 0);
    value = Field(domain, 1);
    reach = domain.layout().ghosts[0] + 2;
  }
  PetscErrorCode follow() { return OccupiedRows::update(domain, {{&rows, std::as_const(value)[0]}}); }
  // Checks the span that span() documents for a single nonzero cell.
  void expect(const Int3 &cell) const {
    const bool flat = domain.dimension() == 2;
    for (int k = 0; k < domain.cells()[2]; ++k)
      for (int j = 0; j < domain.cells()[1]; ++j) {
        const OccupiedRows::Span span = rows.span(j, k);
        const bool near = std::abs(j - cell[1]) <= reach && (flat || std::abs(k - cell[2]) <= reach);
        ASSERT_EQ(!rows.idle(j, k), near) << j << " " << k;
        if (!near) continue;
        ASSERT_LE(span.begin, cell[0] - reach);
        ASSERT_GT(span.end, cell[0] + reach);
        ASSERT_LE(span.end - span.begin, 2 * (reach + 16) + 1) << "pieces of 16 cells, no more";
      }
  }
  Domain domain;
  Field value;
  OccupiedRows rows;
  int reach = 0;
};

}  // namespace

TEST(OccupiedRows, ReachAsFarAsStencilsAndFollow) {
  for (const bool flat : {true, false}) {
    Scene s(flat);
    EXPECT_FALSE(s.rows.idle(0, 0)) << "nothing is known yet";
    ASSERT_EQ(s.rows.find(s.domain, s.value[0]), 0);
    EXPECT_TRUE(s.rows.idle(20, 0));
    EXPECT_EQ(s.rows.cells(), 0);
    Int3 cell{24, 20, flat ? 0 : 20};
    s.value[0](cell[0], cell[1], cell[2]) = 1e-300;
    ASSERT_EQ(s.rows.find(s.domain, s.value[0]), 0);
    s.expect(cell);
    for (int step = 0; step < 3; ++step) {
      s.value[0](cell[0], cell[1], cell[2]) = 0;
      cell = {cell[0] + 1, cell[1] - 1, flat ? 0 : cell[2] + 1};
      s.value[0](cell[0], cell[1], cell[2]) = -1;
      ASSERT_EQ(s.follow(), 0);
      s.expect(cell);
    }
  }
}

TEST(OccupiedRows, WhatIsFarFromEverythingIsNotReadAgain) {
  Scene s(true);
  ASSERT_EQ(s.rows.find(s.domain, s.value[0]), 0);
  s.value[0](24, 20, 0) = 1;
  ASSERT_EQ(s.follow(), 0);
  EXPECT_EQ(s.rows.cells(), 0);
  s.value[0](24, -1, 0) = 1;  // comes from another rank, where no value was near
  ASSERT_EQ(s.follow(), 0);
  EXPECT_TRUE(s.rows.idle(0, 0));
  s.value[0](24, 39, 0) = 1;
  ASSERT_EQ(s.rows.find(s.domain, s.value[0]), 0);
  EXPECT_FALSE(s.rows.inside());
  s.value[0](24, -1, 0) = 0;
  ASSERT_EQ(s.follow(), 0);
  EXPECT_TRUE(s.rows.idle(0, 0));
  s.value[0](24, -1, 0) = 1;  // comes from another rank, where a value is near
  ASSERT_EQ(s.follow(), 0);
  EXPECT_FALSE(s.rows.idle(0, 0));
}

TEST(OccupiedRows, InsideMeansAwayFromAllSides) {
  for (const int j : {20, 12, 11, 28}) {
    Scene s(true);
    s.value[0](24, j, 0) = 1;
    ASSERT_EQ(s.rows.find(s.domain, s.value[0]), 0);
    const int g = s.domain.layout().ghosts[1];
    EXPECT_EQ(s.rows.inside(), j - s.reach >= g && j + s.reach < 40 - g) << j;
  }
}
