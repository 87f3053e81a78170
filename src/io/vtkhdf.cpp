#include "io/vtkhdf.hpp"

#include "grid/domain.hpp"
#include "io/json.hpp"
#include "io/text_file.hpp"

#include <filesystem>

namespace eulastic {

PetscErrorCode write_vtkhdf(const Domain &domain, const std::string &directory, const std::string &name,
                            const std::vector<SnapshotField> &drawn) {
  PetscFunctionBeginUser;
  const Int3 &n = domain.domain_cells();
  const Real3 &h = domain.spacing();
  const std::string root = "VTKHDF", cells = root + "/CellData";
  Hdf5File file;
  PetscCall(file.create(domain.comm(), directory + "/" + name + ".vtkhdf"));
  PetscCall(file.create_group(root));
  PetscCall(file.write_attribute(root, "Version", std::vector<long>{1, 0}));
  PetscCall(file.write_attribute(root, "Type", std::string("ImageData")));
  PetscCall(file.write_attribute(root, "WholeExtent", std::vector<long>{0, n[0], 0, n[1], 0, n[2]}));  // of points
  PetscCall(file.write_attribute(root, "Origin", std::vector<double>{0, 0, 0}));
  PetscCall(file.write_attribute(root, "Spacing", std::vector<double>(h.begin(), h.end())));
  PetscCall(file.write_attribute(root, "Direction", std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1}));
  PetscCall(file.create_group(cells));
  for (const SnapshotField &field : drawn)
    PetscCall(file.link(cells + "/" + field.format.name, name + ".h5", field.format.name));
  PetscCall(file.commit());
  PetscFunctionReturn(0);
}

PetscErrorCode write_vtkhdf_series(MPI_Comm comm, const std::string &directory,
                                   const std::vector<SnapshotEntry> &entries) {
  int rank;
  PetscFunctionBeginUser;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  std::vector<Json> files;
  for (const SnapshotEntry &entry : entries) {
    const std::string name = entry.name + ".vtkhdf";
    std::error_code error;
    if (rank > 0 || !std::filesystem::exists(directory + "/" + name, error)) continue;  // rank 0 writes
    files.emplace_back().add("name", name).add("time", entry.time);
  }
  const std::string text = Json().add("file-series-version", std::string("1.0")).add("files", files).text();
  PetscCall(write_text_file(comm, directory + "/snapshots.vtkhdf.series", text));
  PetscFunctionReturn(0);
}

}  // namespace eulastic
