// HDF5 identifiers that close themselves.
#pragma once

#include <hdf5.h>

#include <type_traits>
#include <utility>
#include <vector>

namespace eulastic {

/// Whether a file could not be closed. HDF5 1.10 then crashes in MPI_Finalize, so that the process must end without it.
inline bool hdf5_file_left_open = false;

template <herr_t (*Close)(hid_t)>
class Hdf5Handle {
public:
  Hdf5Handle() = default;
  explicit Hdf5Handle(hid_t id) : id_(id) {}
  Hdf5Handle(const Hdf5Handle &) = delete;
  Hdf5Handle &operator=(const Hdf5Handle &) = delete;
  Hdf5Handle(Hdf5Handle &&other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Hdf5Handle &operator=(Hdf5Handle &&other) noexcept {
    if (this != &other) {
      (void)close();
      id_ = std::exchange(other.id_, H5I_INVALID_HID);
    }
    return *this;
  }
  ~Hdf5Handle() { (void)close(); }

  hid_t get() const noexcept { return id_; }
  explicit operator bool() const noexcept { return id_ >= 0; }
  /// Leaves the object open for ever.
  void forget() noexcept {
    id_ = H5I_INVALID_HID;
    if (Close == H5Fclose) hdf5_file_left_open = true;
  }
  /// False if HDF5 could not: a file's last bytes may fail to reach the disk here.
  bool close() noexcept {
    const bool closed = id_ < 0 || Close(std::exchange(id_, H5I_INVALID_HID)) >= 0;
    if (Close == H5Fclose) hdf5_file_left_open = hdf5_file_left_open || !closed;
    return closed;
  }

private:
  hid_t id_ = H5I_INVALID_HID;
};

using Hdf5FileHandle = Hdf5Handle<H5Fclose>;
using Hdf5Dataset = Hdf5Handle<H5Dclose>;
using Hdf5Object = Hdf5Handle<H5Oclose>;
using Hdf5Space = Hdf5Handle<H5Sclose>;
using Hdf5Type = Hdf5Handle<H5Tclose>;
using Hdf5Attribute = Hdf5Handle<H5Aclose>;
using Hdf5Property = Hdf5Handle<H5Pclose>;

/// The HDF5 type of T, in memory.
template <class T>
hid_t hdf5_type() {
  if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, int>) return H5T_NATIVE_INT;
  if constexpr (std::is_same_v<T, long>) return H5T_NATIVE_LONG;
  if constexpr (std::is_same_v<T, unsigned char>) return H5T_NATIVE_UCHAR;
}

/// A string of fixed length (parallel HDF5 has no others).
inline Hdf5Type hdf5_string(std::size_t length) {
  Hdf5Type type(H5Tcopy(H5T_C_S1));
  (void)H5Tset_size(type.get(), length > 0 ? length : 1);
  (void)H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  return type;
}

inline std::vector<hsize_t> hdf5_shape(hid_t dataset) {
  const Hdf5Space space(H5Dget_space(dataset));
  const int rank = H5Sget_simple_extent_ndims(space.get());
  std::vector<hsize_t> shape(rank > 0 ? rank : 0);
  if (rank > 0) (void)H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  return shape;
}

/// All ranks move data together.
inline Hdf5Property hdf5_collective() {
  Hdf5Property transfer(H5Pcreate(H5P_DATASET_XFER));
  (void)H5Pset_dxpl_mpio(transfer.get(), H5FD_MPIO_COLLECTIVE);
  return transfer;
}

/// Access to a file by one process, without HDF5's own error messages (the user sees ours) and without a lock of the
/// file: the directory of a run is locked, and not every file system can lock files.
inline Hdf5Property hdf5_local_access() {
  (void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Hdf5Property access(H5Pcreate(H5P_FILE_ACCESS));
  (void)H5Pset_file_locking(access.get(), false, true);
  return access;
}

/// A block of a dataset: its first index and number of values along each of its dimensions, the slowest first.
struct Hdf5Block {
  int rank;
  hsize_t begin[4], count[4];
};

/// Reads a block into `values` of a `type` in memory.
inline bool read_block(hid_t dataset, const Hdf5Block &block, hid_t type, void *values, hid_t transfer = H5P_DEFAULT) {
  const Hdf5Space file(H5Dget_space(dataset)), memory(H5Screate_simple(block.rank, block.count, nullptr));
  return H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, block.begin, nullptr, block.count, nullptr) >= 0 &&
         H5Dread(dataset, type, memory.get(), file.get(), transfer, values) >= 0;
}

/// Writes a block.
inline bool write_block(hid_t dataset, const Hdf5Block &block, hid_t type, const void *values,
                        hid_t transfer = H5P_DEFAULT) {
  const Hdf5Space file(H5Dget_space(dataset)), memory(H5Screate_simple(block.rank, block.count, nullptr));
  return H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, block.begin, nullptr, block.count, nullptr) >= 0 &&
         H5Dwrite(dataset, type, memory.get(), file.get(), transfer, values) >= 0;
}

}  // namespace eulastic
