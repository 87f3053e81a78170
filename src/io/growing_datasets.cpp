#include "io/growing_datasets.hpp"

#include "io/checksum.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <numeric>

namespace eulastic {
namespace {

constexpr hsize_t chunk_bodies = 1 << 13;

// The value in rows before the body entered.
double value_before_entry(const std::string &column) { return column == "volume" ? 0 : std::nan(""); }

// Of the rows from `begin` on.
bool checksum_of_rows(hid_t dataset, const std::vector<hsize_t> &shape, hsize_t begin, std::uint64_t *sum) {
  std::vector<hsize_t> start(shape.size(), 0), one = shape;
  one[0] = 1;
  const hsize_t row = std::accumulate(one.begin(), one.end(), hsize_t{1}, std::multiplies<>());
  std::vector<double> values(row);
  *sum = 0;
  for (start[0] = begin; start[0] < shape[0]; ++start[0]) {
    if (!read_block(dataset, static_cast<int>(one.size()), start.data(), one.data(), values.data())) return false;
    *sum += checksum(values.data(), row, start[0] * row);
  }
  return true;
}

}  // namespace

bool write_text_attribute(hid_t object, const char *name, const std::string &text) {
  const Hdf5Type type = hdf5_string(text.size());
  const Hdf5Space space(H5Screate(H5S_SCALAR));
  const Hdf5Attribute attribute(H5Aexists(object, name) > 0
                                    ? H5Aopen(object, name, H5P_DEFAULT)
                                    : H5Acreate2(object, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT));
  return H5Awrite(attribute.get(), type.get(), text.c_str()) >= 0;
}

bool write_checksum(hid_t file, const char *name, std::uint64_t sum) {
  Hdf5Dataset dataset(H5Dopen2(file, name, H5P_DEFAULT));
  return write_text_attribute(dataset.get(), "checksum", checksum_text(sum)) && dataset.close();
}

bool set_rows(hid_t file, const char *name, const RowsPart &whole) {
  const hsize_t total[3] = {whole.row + whole.rows, whole.bodies, whole.width};
  if (H5Lexists(file, name, H5P_DEFAULT) > 0) {
    Hdf5Dataset dataset(H5Dopen2(file, name, H5P_DEFAULT));
    return H5Dset_extent(dataset.get(), total) >= 0 && dataset.close();
  }
  const hsize_t chunk_row = std::min(std::max<hsize_t>(1, whole.bodies), chunk_bodies);
  const hsize_t limit[3] = {H5S_UNLIMITED, H5S_UNLIMITED, whole.width};
  const hsize_t values = chunk_row * std::max<hsize_t>(1, whole.width);
  const hsize_t chunk[3] = {std::clamp<hsize_t>(8192 / values, 1, 1024), chunk_row, whole.width};  // 64 kB
  const Hdf5Space space(H5Screate_simple(whole.rank(), total, limit));
  const Hdf5Property creation(H5Pcreate(H5P_DATASET_CREATE));
  (void)H5Pset_chunk(creation.get(), whole.rank(), chunk);
  const double before = value_before_entry(name);
  (void)H5Pset_fill_value(creation.get(), H5T_NATIVE_DOUBLE, &before);
  Hdf5Dataset dataset(H5Dcreate2(file, name, H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
  return dataset.close();
}

bool write_part(hid_t file, const char *name, const RowsPart &part, const std::vector<double> &values) {
  const hsize_t start[3] = {part.row, part.body, 0}, size[3] = {part.rows, part.bodies, part.width};
  Hdf5Dataset dataset(H5Dopen2(file, name, H5P_DEFAULT));
  return write_block(dataset.get(), part.rank(), start, size, values.data()) && dataset.close();
}

bool set_bodies(hid_t file, const char *name, hsize_t bodies, std::uint64_t *sum) {
  Hdf5Dataset dataset(H5Dopen2(file, name, H5P_DEFAULT));
  std::vector<hsize_t> shape = hdf5_shape(dataset.get());
  if (shape.size() < 2) return false;
  shape[1] = bodies;
  if (H5Dset_extent(dataset.get(), shape.data()) < 0) return false;
  return checksum_of_rows(dataset.get(), shape, 0, sum) && dataset.close();
}

bool cut_rows(hid_t file, const char *name, hsize_t rows, std::uint64_t *sum) {
  Hdf5Dataset dataset(H5Dopen2(file, name, H5P_DEFAULT));
  std::vector<hsize_t> shape = hdf5_shape(dataset.get());
  char text[17] = "";
  const Hdf5Attribute attribute(H5Aopen(dataset.get(), "checksum", H5P_DEFAULT));
  if (shape.empty() || shape[0] < rows || H5Aread(attribute.get(), hdf5_string(16).get(), text) < 0) return false;
  *sum = std::strtoull(text, nullptr, 16);
  std::uint64_t lost = 0;
  if (!checksum_of_rows(dataset.get(), shape, rows, &lost)) return false;
  *sum -= lost;
  shape[0] = rows;
  return H5Dset_extent(dataset.get(), shape.data()) >= 0 &&
         write_text_attribute(dataset.get(), "checksum", checksum_text(*sum)) && dataset.close();
}

}  // namespace eulastic
