#include "output/bond_files.hpp"

namespace eulastic {

PetscErrorCode BondFiles::open(MPI_Comm comm, const std::string &directory, const Position &position) {
  PetscFunctionBeginUser;
  PetscCall(bodies_.open(comm, directory + "/adhesion.csv",
                         {"time", "body", "bonds", "force_x", "force_y", "force_z", "tension", "age"},
                         static_cast<long>(position.bodies)));
  PetscCall(
      bonds_.open(comm, directory + "/adhesion_bonds.csv",
                  {"time", "body", "partner", "from_x", "from_y", "from_z", "to_x", "to_y", "to_z", "tension", "since"},
                  static_cast<long>(position.bonds)));
  PetscCall(events_.open(comm, directory + "/adhesion_events.csv",
                         {"time", "formed", "body", "partner", "pair", "tension", "age"},
                         static_cast<long>(position.events)));
  PetscFunctionReturn(0);
}

void BondFiles::moved_to(const std::string &directory) {
  bodies_.moved_to(directory + "/adhesion.csv");
  bonds_.moved_to(directory + "/adhesion_bonds.csv");
  events_.moved_to(directory + "/adhesion_events.csv");
}

PetscErrorCode BondFiles::write_bodies(double time, Adhesion *adhesion) {
  PetscFunctionBeginUser;
  for (const BodyBonds &b : adhesion->measure())
    PetscCall(
        bodies_.write({time, double(b.body), double(b.bonds), b.force[0], b.force[1], b.force[2], b.tension, b.age}));
  for (const BondEvent &e : adhesion->take_events())
    PetscCall(
        events_.write({e.time, double(e.formed), double(e.body), double(e.partner), double(e.pair), e.tension, e.age}));
  PetscFunctionReturn(0);
}

PetscErrorCode BondFiles::write_bonds(double time, const Adhesion &adhesion) {
  PetscFunctionBeginUser;
  for (const Adhesion::Line &line : adhesion.lines())
    PetscCall(bonds_.write({time, double(line.body), double(line.partner), line.from[0], line.from[1], line.from[2],
                            line.to[0], line.to[1], line.to[2], line.tension, line.since}));
  PetscFunctionReturn(0);
}

PetscErrorCode BondFiles::sync(Position *position) {
  PetscFunctionBeginUser;
  for (Series *series : {&bodies_, &bonds_, &events_}) PetscCall(series->sync());
  *position = {bodies_.rows(), bonds_.rows(), events_.rows()};
  PetscFunctionReturn(0);
}

}  // namespace eulastic
