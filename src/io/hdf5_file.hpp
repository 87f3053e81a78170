// One HDF5 file written or read by all ranks together (MPI-IO, collective): fields, small arrays, attributes.
//
// A file is written as NAME.tmp, synced and renamed by commit(); without it nothing remains. Every dataset has an
// attribute `checksum` that does not depend on the ranks and is verified on read. Errors are the same on all ranks.
#pragma once

#include "base/petsc.hpp"
#include "field/boundaries.hpp"
#include "io/hdf5_handle.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace eulastic {

/// How values are stored: 4- or 8-byte reals, or 4-byte integers (labels).
enum class Stored { float32, float64, int32 };

struct FieldFormat {
  std::string name;
  Staggering staggering = at_centre;
  Stored stored = Stored::float64;
  bool high_wall = false;  ///< also index N (the high wall) where the field is staggered
  int plane = -1;          ///< 0, 1, 2: only the cells on the wall normal to x, y, z, held by the ranks that touch it
  bool plane_high = false;
};

/// "centre", "face_x", "edge_xy", ...: the attribute `location`.
std::string location_name(const Staggering &staggering);

class Hdf5File {
public:
  Hdf5File() = default;
  Hdf5File(const Hdf5File &) = delete;
  Hdf5File &operator=(const Hdf5File &) = delete;
  ~Hdf5File();

  // All members are collective over the communicator given here.
  PetscErrorCode create(MPI_Comm comm, const std::string &path);
  PetscErrorCode open(MPI_Comm comm, const std::string &path);
  /// Completes a file that was created.
  PetscErrorCode commit();

  /// Owned points in natural order: (nz,ny,nx), or (nz,ny,nx,components) of more than one component.
  PetscErrorCode write_field(const Box &box, const FieldFormat &format, const std::vector<ConstView> &components);
  /// Reads a scalar (nz,ny,nx), any numeric type, into the owned points. Where the field is staggered towards a
  /// wall the dataset may have N + 1 points; if it has N, the high wall is left as it is. Ghosts are untouched.
  PetscErrorCode read_field(const Box &box, const std::string &name, const Staggering &staggering, View field);

  /// Writes records of `numbers` numbers, of which every rank has some: (records, 1, numbers), in the order of the
  /// ranks. Nothing is written if no rank has any.
  PetscErrorCode write_records(const std::string &name, std::size_t numbers, const std::vector<double> &values);
  /// Each rank gets an equal share of them.
  PetscErrorCode read_records(const std::string &name, std::size_t numbers, std::vector<double> *values);

  /// Writes and reads an array (values) of rank 0, which all ranks get; T = double, long or unsigned char (text).
  template <class T>
  PetscErrorCode write_array(const std::string &name, const std::vector<T> &values);
  template <class T>
  PetscErrorCode read_array(const std::string &name, std::vector<T> *values);
  /// Reads this rank's part of an array, or of records of one number: as many values as `values` has. The parts follow
  /// one another in the order of the ranks and must be the whole dataset. T = double or long.
  template <class T>
  PetscErrorCode read_own(const std::string &name, std::vector<T> *values);

  /// Attributes of `object`: a dataset, a group, or "/" for the file.
  PetscErrorCode write_attribute(const std::string &object, const std::string &name, const std::string &value) {
    return write_raw_attribute(object, name, hdf5_string(value.size()).get(), 1, value.c_str());
  }
  PetscErrorCode write_attribute(const std::string &object, const std::string &name, const Real3 &value) {
    return write_raw_attribute(object, name, H5T_NATIVE_DOUBLE, value.size(), value.data());
  }
  PetscErrorCode write_attribute(const std::string &object, const std::string &name, double value) {
    return write_raw_attribute(object, name, H5T_NATIVE_DOUBLE, 1, &value);
  }
  PetscErrorCode write_attribute(const std::string &object, const std::string &name, long value) {
    return write_raw_attribute(object, name, H5T_NATIVE_LONG, 1, &value);
  }
  PetscErrorCode read_attribute(const std::string &object, const std::string &name, std::string *value);
  /// Reads `count` numbers.
  PetscErrorCode read_attribute(const std::string &object, const std::string &name, double *values, int count = 1);

  bool has(const std::string &dataset) const;
  bool has_attribute(const std::string &object, const std::string &name) const;
  /// Names at the root of the file.
  std::vector<std::string> datasets() const;

protected:
  /// Collective. Fails on all ranks with "PATH: `problem`" if any has not `fine`.
  PetscErrorCode check(bool fine, const std::string &problem) const;

private:
  /// This rank's block of a dataset whose whole shape is `total`.
  struct Hyperslab : Hdf5Block {
    hsize_t total[4];
  };
  static Hyperslab owned_box(const Box &box, const Int3 &extra, std::size_t components);
  template <class T>
  PetscErrorCode write_values(const std::string &name, const Hyperslab &box, const std::vector<T> &values);
  template <class T>
  PetscErrorCode write_field_as(const Box &box, const FieldFormat &format, const std::vector<ConstView> &components);
  /// Compares with the checksum of the dataset, if it has one.
  template <class T>
  PetscErrorCode read_values(const std::string &name, hid_t dataset, const Hyperslab &box, std::vector<T> *values);
  template <class T>
  PetscErrorCode read_field_as(const std::string &name, hid_t dataset, const Hyperslab &box, View field);
  PetscErrorCode own_rows(hsize_t mine, hsize_t *begin, hsize_t *all) const;
  PetscErrorCode write_raw_attribute(const std::string &object, const std::string &name, hid_t type, hsize_t count,
                                     const void *values);
  PetscErrorCode open_dataset(const std::string &name, Hdf5Dataset *dataset) const;
  PetscErrorCode open_attribute(const std::string &object, const std::string &name, Hdf5Attribute *attribute);

  MPI_Comm comm_ = MPI_COMM_NULL;
  int mpi_rank_ = 0;
  bool writing_ = false;
  std::string path_;
  Hdf5FileHandle file_;
};

}  // namespace eulastic
