// HDF5 datasets of voxels, read box by box.
#include "io/hdf5_input.hpp"
#include "io/volume_file.hpp"

#include <algorithm>

namespace eulastic {
namespace {

constexpr double best_compression = 2000;  // beyond deflate's 1032: such a header is invalid

class Hdf5Volume : public VolumeFile {
public:
  std::string open(const std::string &file, const std::string &dataset) {
    file_ = file;
    if (std::string wrong = open_input(file, dataset, "solid_fraction", &input_); !wrong.empty()) return wrong;
    if (std::string wrong = read_type(); !wrong.empty()) return wrong;
    if (std::string wrong = read_shape(); !wrong.empty()) return wrong;
    std::vector<double> values;
    if (std::string wrong = read_attribute("spacing", &values); !wrong.empty()) return wrong;
    if (std::string wrong = set_spacing(values); !wrong.empty()) return wrong;
    if (std::string wrong = read_attribute("origin", &values); !wrong.empty()) return wrong;
    std::copy(values.begin(), values.end(), corner_.begin());
    return {};
  }

protected:
  std::string read_values(const Int3 &begin, const Int3 &end, double *values) override {
    Hdf5Block block{rank_, {}, {}};
    std::size_t n = 1;
    for (int d = 0; d < rank_; ++d) {
      block.begin[rank_ - 1 - d] = hsize_t(begin[d]);
      block.count[rank_ - 1 - d] = hsize_t(end[d] - begin[d]);
      n *= std::size_t(end[d] - begin[d]);
    }
    if (mask_) bytes_.resize(n * size_);
    void *const read = mask_ ? static_cast<void *>(bytes_.data()) : values;
    if (!read_block(input_.dataset.get(), block, mask_ ? type_.get() : H5T_NATIVE_DOUBLE, read))
      return "its values cannot be read, it is truncated or damaged";
    for (std::size_t v = 0; mask_ && v < n; ++v) {
      const auto voxel = bytes_.begin() + static_cast<std::ptrdiff_t>(v * size_);
      values[v] =
          std::any_of(voxel, voxel + static_cast<std::ptrdiff_t>(size_), [](unsigned char b) { return b != 0; });
    }
    return {};
  }

private:
  std::string refuse(const std::string &wrong) const { return file_ + ": dataset " + input_.name + " " + wrong; }

  std::string read_type() {
    type_ = Hdf5Type(H5Dget_type(input_.dataset.get()));
    size_ = H5Tget_size(type_.get());
    const H5T_class_t kind = H5Tget_class(type_.get());
    mask_ = kind == H5T_INTEGER || kind == H5T_ENUM || kind == H5T_BITFIELD;  // h5py writes booleans as an enum
    if ((!mask_ && kind != H5T_FLOAT) || size_ < 1 || size_ > 16)
      return refuse("has no numbers; accepted: integers and booleans as a mask, or floating-point numbers");
    return {};
  }

  std::string read_shape() {
    const std::vector<hsize_t> shape = hdf5_shape(input_.dataset.get());
    rank_ = static_cast<int>(shape.size());
    if (rank_ != 2 && rank_ != 3)
      return refuse("has " + std::to_string(rank_) + " dimensions; accepted: 3 as (nz, ny, nx), or 2 as (ny, nx)");
    const Hdf5Property creation(H5Dget_create_plist(input_.dataset.get()));
    const bool chunked = H5Pget_layout(creation.get()) == H5D_CHUNKED;
    if (!filters_are_there(creation.get()))
      return refuse("is compressed by a filter that this HDF5 lacks; accepted: gzip, or no compression");
    const double stored = double(H5Dget_storage_size(input_.dataset.get()));
    if (stored == 0) return refuse("has no values; accepted: one value per voxel");
    hsize_t chunk[3] = {1, 1, 1};
    if (chunked) (void)H5Pget_chunk(creation.get(), rank_, chunk);
    const double chunk_bytes = double(chunk[0]) * double(chunk[1]) * double(chunk[2]) * double(size_);
    const double most = chunked ? best_compression * stored : stored;
    if (chunk_bytes > most) return refuse("is damaged: one chunk would be larger than the file");
    return set_count({shape.rbegin(), shape.rend()}, double(size_), most);
  }

  static bool filters_are_there(hid_t creation) {
    for (int f = 0; f < H5Pget_nfilters(creation); ++f) {
      unsigned flags = 0, config = 0;
      std::size_t elements = 0;
      const H5Z_filter_t filter =
          H5Pget_filter2(creation, static_cast<unsigned>(f), &flags, &elements, nullptr, 0, nullptr, &config);
      if (filter < 0 || H5Zfilter_avail(filter) <= 0) return false;  // loads a plugin
    }
    return true;
  }

  // One number for each direction, x first; none if it is not there.
  std::string read_attribute(const std::string &name, std::vector<double> *values) const {
    values->clear();
    if (H5Aexists(input_.dataset.get(), name.c_str()) <= 0) return {};
    const Hdf5Attribute attribute(H5Aopen(input_.dataset.get(), name.c_str(), H5P_DEFAULT));
    const Hdf5Space space(H5Aget_space(attribute.get()));
    const Hdf5Type type(H5Aget_type(attribute.get()));
    const H5T_class_t kind = H5Tget_class(type.get());
    const hssize_t count = H5Sget_simple_extent_npoints(space.get());
    values->resize(count == 2 || count == 3 ? static_cast<std::size_t>(count) : 0);
    const bool fine = (kind == H5T_FLOAT || kind == H5T_INTEGER) && count >= rank_ && count <= 3 &&
                      H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, values->data()) >= 0 &&
                      std::all_of(values->begin(), values->end(), [](double v) { return v - v == 0; });
    return fine ? "" : file_ + ": attribute " + name + " must be " + std::to_string(rank_) + " finite numbers, x first";
  }

  Hdf5Input input_;
  Hdf5Type type_;
  int rank_ = 3;
  std::size_t size_ = 0;
  bool mask_ = false;
  std::vector<unsigned char> bytes_;
};

}  // namespace

std::string open_hdf5_volume(const std::string &file, const std::string &dataset, std::unique_ptr<VolumeFile> *volume) {
  auto opened = std::make_unique<Hdf5Volume>();
  std::string wrong = opened->open(file, dataset);
  if (wrong.empty()) *volume = std::move(opened);
  return wrong;
}

}  // namespace eulastic
