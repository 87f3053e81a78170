// Colours of graphs by hand: never one for a pair, as few as these graphs need.
#include "bodies/colouring.hpp"

#include <gtest/gtest.h>

#include <algorithm>

using namespace eulastic;

namespace {

int colours_of(const std::vector<int> &bodies, const std::vector<NearBodies> &pairs) {
  const std::vector<int> colour = colour_bodies(bodies, pairs);
  EXPECT_EQ(colour.size(), bodies.size());
  const auto at = [&](int label) { return colour[std::find(bodies.begin(), bodies.end(), label) - bodies.begin()]; };
  for (const NearBodies &pair : pairs) EXPECT_NE(at(pair.body), at(pair.other));
  return bodies.empty() ? 0 : 1 + *std::max_element(colour.begin(), colour.end());
}

// A ring of n bodies with the labels 10, 11, ...
int ring(int n) {
  std::vector<int> bodies;
  std::vector<NearBodies> pairs;
  for (int b = 0; b < n; ++b) {
    bodies.push_back(10 + b);
    pairs.push_back({10 + b, 10 + (b + 1) % n, 0});
    pairs.push_back({10 + (b + 1) % n, 10 + b, 3});  // the same again
  }
  return colours_of(bodies, pairs);
}

}  // namespace

TEST(Colouring, AsFewAsNeeded) {
  EXPECT_EQ(colours_of({}, {}), 0);
  EXPECT_EQ(colours_of({3, 5, 9}, {}), 1);
  EXPECT_EQ(ring(8), 2);
  EXPECT_EQ(ring(9), 3);
  // A crown: each even label beside all odd ones but the next.
  std::vector<int> bodies;
  std::vector<NearBodies> crown, all;
  for (int a = 0; a < 6; ++a)
    for (int b = 0; b < 6; ++b)
      if (a != b) crown.push_back({2 * a, 2 * b + 1, 0});  // first come, first served: six
  for (int b = 0; b < 12; ++b) bodies.push_back(b);
  EXPECT_EQ(colours_of(bodies, crown), 2);
  for (int a = 0; a < 12; ++a)
    for (int b = 0; b < a; ++b) all.push_back({a, b, 0});
  EXPECT_EQ(colours_of(bodies, all), 12);
}
