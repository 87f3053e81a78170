// Hdf5File: small arrays and attributes.
#include "base/rank_zero.hpp"
#include "io/checksum.hpp"
#include "io/hdf5_file.hpp"

namespace eulastic {

PetscErrorCode Hdf5File::verify(const std::string &name, std::uint64_t sum) {
  std::string stored;
  PetscFunctionBeginUser;
  if (!has_attribute(name, "checksum")) PetscFunctionReturn(0);
  PetscCall(read_attribute(name, "checksum", &stored));
  PetscCall(check(stored == checksum_text(sum), "dataset " + name + " is damaged (its checksum differs)"));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::write_array(const std::string &name, const std::vector<hsize_t> &shape,
                                     const std::vector<T> &values) {
  PetscFunctionBeginUser;
  const Hdf5Space space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr));
  Hdf5Dataset dataset(
      H5Dcreate2(file_.get(), name.c_str(), hdf5_type<T>(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  PetscCall(check(bool(dataset), "cannot create dataset " + name));
  if (mpi_rank_ > 0) (void)H5Sselect_none(space.get());
  const Hdf5Property transfer = hdf5_collective();
  const bool written =
      H5Dwrite(dataset.get(), hdf5_type<T>(), space.get(), space.get(), transfer.get(), values.data()) >= 0;
  PetscCall(check(dataset.close() && written, "cannot write dataset " + name + " (disk full?)"));
  std::uint64_t sum = mpi_rank_ == 0 ? checksum(values.data(), values.size(), 0) : 0;
  PetscCallMPI(MPI_Bcast(&sum, 1, MPI_UINT64_T, 0, comm_));
  PetscCall(write_attribute(name, "checksum", checksum_text(sum)));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::read_array(const std::string &name, std::vector<hsize_t> *shape, std::vector<T> *values) {
  Hdf5Dataset dataset;
  PetscFunctionBeginUser;
  PetscCall(open_dataset(name, &dataset));
  *shape = hdf5_shape(dataset.get());
  double promised = 1;
  hsize_t file_bytes = 0;
  for (const hsize_t n : *shape) promised *= double(n);
  PetscCall(check(H5Fget_filesize(file_.get(), &file_bytes) >= 0 && promised <= double(file_bytes),
                  "dataset " + name + " would be larger than its file"));
  const auto count = static_cast<std::size_t>(promised);
  values->resize(count);
  const Hdf5Space space(H5Dget_space(dataset.get()));
  if (mpi_rank_ > 0) (void)H5Sselect_none(space.get());
  const Hdf5Property transfer = hdf5_collective();
  const bool read =
      H5Dread(dataset.get(), hdf5_type<T>(), space.get(), space.get(), transfer.get(), values->data()) >= 0;
  PetscCall(check(read, "cannot read dataset " + name));
  PetscCallMPI(share_bytes(values->data(), count * sizeof(T), comm_));
  PetscCall(verify(name, checksum(values->data(), count, 0)));
  PetscFunctionReturn(0);
}

template PetscErrorCode Hdf5File::write_array(const std::string &, const std::vector<hsize_t> &,
                                              const std::vector<double> &);
template PetscErrorCode Hdf5File::write_array(const std::string &, const std::vector<hsize_t> &,
                                              const std::vector<long> &);
template PetscErrorCode Hdf5File::write_array(const std::string &, const std::vector<hsize_t> &,
                                              const std::vector<unsigned char> &);
template PetscErrorCode Hdf5File::read_array(const std::string &, std::vector<hsize_t> *, std::vector<double> *);
template PetscErrorCode Hdf5File::read_array(const std::string &, std::vector<hsize_t> *, std::vector<long> *);
template PetscErrorCode Hdf5File::read_array(const std::string &, std::vector<hsize_t> *, std::vector<unsigned char> *);

PetscErrorCode Hdf5File::write_raw_attribute(const std::string &object, const std::string &name, hid_t type,
                                             const Hdf5Space &space, const void *value) {
  PetscFunctionBeginUser;
  Hdf5Attribute attribute(H5Acreate_by_name(file_.get(), object.c_str(), name.c_str(), type, space.get(), H5P_DEFAULT,
                                            H5P_DEFAULT, H5P_DEFAULT));
  const bool written = attribute && H5Awrite(attribute.get(), type, value) >= 0;
  PetscCall(check(attribute.close() && written, "cannot write attribute " + name + " of " + object));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::write_attribute(const std::string &object, const std::string &name, const std::string &value) {
  PetscFunctionBeginUser;
  PetscCall(write_raw_attribute(object, name, hdf5_string(value.size()).get(), Hdf5Space(H5Screate(H5S_SCALAR)),
                                value.c_str()));
  PetscFunctionReturn(0);
}

template <class T>
PetscErrorCode Hdf5File::write_attribute(const std::string &object, const std::string &name,
                                         const std::vector<T> &value) {
  PetscFunctionBeginUser;
  const hsize_t count = value.size();
  PetscCall(
      write_raw_attribute(object, name, hdf5_type<T>(), Hdf5Space(H5Screate_simple(1, &count, nullptr)), value.data()));
  PetscFunctionReturn(0);
}

template PetscErrorCode Hdf5File::write_attribute(const std::string &, const std::string &,
                                                  const std::vector<double> &);
template PetscErrorCode Hdf5File::write_attribute(const std::string &, const std::string &, const std::vector<long> &);

PetscErrorCode Hdf5File::write_attribute(const std::string &object, const std::string &name, double value) {
  PetscFunctionBeginUser;
  PetscCall(write_raw_attribute(object, name, H5T_NATIVE_DOUBLE, Hdf5Space(H5Screate(H5S_SCALAR)), &value));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::write_attribute(const std::string &object, const std::string &name, long value) {
  PetscFunctionBeginUser;
  PetscCall(write_raw_attribute(object, name, H5T_NATIVE_LONG, Hdf5Space(H5Screate(H5S_SCALAR)), &value));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::open_attribute(const std::string &object, const std::string &name, Hdf5Attribute *attribute) {
  PetscFunctionBeginUser;
  *attribute = Hdf5Attribute(H5Aopen_by_name(file_.get(), object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
  PetscCall(check(bool(*attribute), "there is no attribute " + name + " of " + object));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::read_attribute(const std::string &object, const std::string &name, std::string *value) {
  Hdf5Attribute attribute;
  PetscFunctionBeginUser;
  PetscCall(open_attribute(object, name, &attribute));
  const Hdf5Type type(H5Aget_type(attribute.get()));
  const Hdf5Space space(H5Aget_space(attribute.get()));
  const bool fixed = H5Tget_class(type.get()) == H5T_STRING && H5Tis_variable_str(type.get()) == 0 &&
                     H5Sget_simple_extent_npoints(space.get()) == 1;
  value->assign(fixed ? H5Tget_size(type.get()) : 0, '\0');
  PetscCall(check(fixed && H5Aread(attribute.get(), type.get(), value->data()) >= 0,
                  "cannot read attribute " + name + " of " + object + " as one string of fixed length"));
  value->resize(std::char_traits<char>::length(value->c_str()));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::read_attribute(const std::string &object, const std::string &name,
                                        std::vector<double> *value) {
  Hdf5Attribute attribute;
  PetscFunctionBeginUser;
  PetscCall(open_attribute(object, name, &attribute));
  const Hdf5Space space(H5Aget_space(attribute.get()));
  value->resize(H5Sget_simple_extent_npoints(space.get()));
  PetscCall(check(H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, value->data()) >= 0,
                  "cannot read attribute " + name + " of " + object + " as numbers"));
  PetscFunctionReturn(0);
}

PetscErrorCode Hdf5File::read_attribute(const std::string &object, const std::string &name, double *value) {
  std::vector<double> values;
  PetscFunctionBeginUser;
  PetscCall(read_attribute(object, name, &values));
  PetscCall(check(values.size() == 1, "attribute " + name + " of " + object + " is not one number"));
  *value = values[0];
  PetscFunctionReturn(0);
}

}  // namespace eulastic
