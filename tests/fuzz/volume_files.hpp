// NRRD volumes and STL surfaces of every form that the program reads.
#pragma once

#include "fuzz/dice.hpp"

namespace eulastic::fuzz {

/// A volume of a few voxels: any type, encoding, byte order, order of fields. One in four is right; of the others the
/// header is spoilt or its fields exchanged, the data are damaged, or cut.
std::string nrrd_volume(Dice &dice);

/// A tetrahedron, binary or ascii, mostly with something wrong: corners, counts, words, bits, its end.
std::string stl_surface(Dice &dice);

}  // namespace eulastic::fuzz
