#include "output/bond_files.hpp"

namespace eulastic {

PetscErrorCode BondFiles::open(MPI_Comm comm, const std::string &directory, const Position &position) {
  PetscFunctionBeginUser;
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
  bonds_.moved_to(directory + "/adhesion_bonds.csv");
  events_.moved_to(directory + "/adhesion_events.csv");
}

PetscErrorCode BondFiles::write_events(Adhesion *adhesion) {
  std::vector<BondEvent> events;
  std::vector<std::vector<double>> rows;
  PetscFunctionBeginUser;
  PetscCall(adhesion->take_events(&events));
  for (const BondEvent &e : events)
    rows.push_back(
        {e.time, double(e.formed), double(e.receptor.body), double(e.partner.body), double(e.pair), e.tension, e.age});
  PetscCall(events_.write_rows(rows));
  PetscFunctionReturn(0);
}

PetscErrorCode BondFiles::write_bonds(double time, const Adhesion &adhesion) {
  std::vector<BondLine> lines;
  std::vector<std::vector<double>> rows;
  PetscFunctionBeginUser;
  PetscCall(adhesion.lines(&lines));
  for (const BondLine &line : lines)
    rows.push_back({time, double(line.receptor.body), double(line.partner.body), line.from[0], line.from[1],
                    line.from[2], line.to[0], line.to[1], line.to[2], line.tension, line.since});
  PetscCall(bonds_.write_rows(rows));
  PetscFunctionReturn(0);
}

PetscErrorCode BondFiles::sync(Position *position) {
  PetscFunctionBeginUser;
  for (Series *series : {&bonds_, &events_}) PetscCall(series->sync());
  *position = {bonds_.rows(), events_.rows()};
  PetscFunctionReturn(0);
}

}  // namespace eulastic
