#include "io/growing_dataset.hpp"

#include "io/checksum.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace eulastic {
namespace {

constexpr hsize_t chunk_bodies = 1 << 13;

// The value in rows before the body entered.
double value_before_entry(const std::string &column) { return column == "volume" ? 0 : std::nan(""); }

hsize_t values_per_row(const std::vector<hsize_t> &shape) {
  hsize_t values = 1;
  for (std::size_t d = 1; d < shape.size(); ++d) values *= shape[d];
  return values;
}

// The checksum of rows [begin, end).
bool sum_rows(hid_t dataset, hsize_t begin, hsize_t end, std::uint64_t *sum) {
  const std::vector<hsize_t> shape = hdf5_shape(dataset);
  Hdf5Block row{static_cast<int>(shape.size()), {}, {}};
  std::copy(shape.begin(), shape.end(), row.count);
  row.count[0] = 1;
  std::vector<double> values(values_per_row(shape));
  *sum = 0;
  for (row.begin[0] = begin; row.begin[0] < end; ++row.begin[0]) {
    if (!read_block(dataset, row, H5T_NATIVE_DOUBLE, values.data())) return false;
    *sum += checksum(values.data(), values.size(), row.begin[0] * values.size());
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

bool GrowingDataset::create(hid_t file, hsize_t rows, hsize_t bodies) const {
  const hsize_t total[3] = {rows, bodies, width_}, limit[3] = {H5S_UNLIMITED, H5S_UNLIMITED, width_};
  const hsize_t chunk_row = std::min(std::max<hsize_t>(1, bodies), chunk_bodies);
  const hsize_t chunk[3] = {std::clamp<hsize_t>(8192 / (chunk_row * width_), 1, 1024), chunk_row, width_};  // 64 kB
  const Hdf5Space space(H5Screate_simple(rank_, total, limit));
  const Hdf5Property creation(H5Pcreate(H5P_DATASET_CREATE));
  (void)H5Pset_chunk(creation.get(), rank_, chunk);
  const double before = value_before_entry(name_);
  (void)H5Pset_fill_value(creation.get(), H5T_NATIVE_DOUBLE, &before);
  Hdf5Dataset dataset(H5Dcreate2(file, name_, H5T_IEEE_F64LE, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
  return dataset.close();
}

bool GrowingDataset::resize(hid_t file, hsize_t rows, hsize_t bodies) {
  if (H5Lexists(file, name_, H5P_DEFAULT) <= 0) return create(file, rows, bodies);
  const hsize_t total[3] = {rows, bodies, width_};
  Hdf5Dataset dataset = open(file);
  const std::vector<hsize_t> before = hdf5_shape(dataset.get());
  if (before.size() != static_cast<std::size_t>(rank_) || H5Dset_extent(dataset.get(), total) < 0) return false;
  if (rank_ > 1 && before[1] != bodies && !sum_rows(dataset.get(), 0, before[0], &checksum_)) return false;
  return dataset.close();
}

bool GrowingDataset::write(hid_t file, hsize_t row, hsize_t body, hsize_t bodies, const std::vector<double> &values) {
  Hdf5Dataset dataset = open(file);
  const hsize_t whole_row = values_per_row(hdf5_shape(dataset.get())), part = bodies * width_;
  const hsize_t rows = values.size() / part;
  for (hsize_t r = 0; r < rows; ++r)
    checksum_ += checksum(values.data() + r * part, part, (row + r) * whole_row + body * width_);
  const Hdf5Block block{rank_, {row, body, 0}, {rows, bodies, width_}};
  return write_block(dataset.get(), block, H5T_NATIVE_DOUBLE, values.data()) && dataset.close();
}

bool GrowingDataset::cut(hid_t file, hsize_t rows) {
  Hdf5Dataset dataset = open(file);
  std::vector<hsize_t> shape = hdf5_shape(dataset.get());
  char text[17] = "";
  const Hdf5Attribute attribute(H5Aopen(dataset.get(), "checksum", H5P_DEFAULT));
  if (shape.empty() || shape[0] < rows || H5Aread(attribute.get(), hdf5_string(16).get(), text) < 0) return false;
  std::uint64_t lost = 0;
  if (!sum_rows(dataset.get(), rows, shape[0], &lost)) return false;
  checksum_ = std::strtoull(text, nullptr, 16) - lost;
  shape[0] = rows;
  return H5Dset_extent(dataset.get(), shape.data()) >= 0 && dataset.close() && write_checksum(file);
}

bool GrowingDataset::write_checksum(hid_t file) const {
  Hdf5Dataset dataset = open(file);
  return write_text_attribute(dataset.get(), "checksum", checksum_text(checksum_)) && dataset.close();
}

}  // namespace eulastic
