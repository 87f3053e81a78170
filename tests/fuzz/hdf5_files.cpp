#include "fuzz/hdf5_files.hpp"

#include "io/checksum.hpp"
#include "io/hdf5_handle.hpp"

#include <cmath>
#include <limits>

namespace eulastic::fuzz {
namespace {

const std::vector<std::string> state_names{"velocity_x",
                                           "velocity_y",
                                           "velocity_z",
                                           "pressure",
                                           "solid_fraction",
                                           "body",
                                           "left_cauchy_green_xx",
                                           "left_cauchy_green_yy",
                                           "left_cauchy_green_zz",
                                           "left_cauchy_green_xy",
                                           "left_cauchy_green_yz",
                                           "left_cauchy_green_xz",
                                           "solid_fraction_cell",
                                           "body_cell",
                                           "left_cauchy_green_xy_cell",
                                           "velocity",
                                           "wall_shear_stress_ymin"};
const std::vector<std::string> odd_names{"x", "solid_fraction_", "velocity_w", "body_bead", "..", "a b", "\xff"};

double usual(const std::string &name, Dice &dice) {
  if (name.rfind("solid", 0) == 0) return dice.below(2) ? 1 : 0.25;
  if (name.rfind("body", 0) == 0) return 1;
  const auto has = [&](const char *part) { return name.find(part) != std::string::npos; };
  if (has("left")) return has("xx") || has("yy") || has("zz") ? 1 : 0;
  return 0.01 * static_cast<double>(dice.below(100));
}

void make_dataset(Dice &dice, hid_t file, const std::string &name, const int (&cells)[3]) {
  static const std::vector<double> odd{
      std::nan(""), std::numeric_limits<double>::infinity(), -1, 2, 1e300, 1.5, -0.05, 2147483648.0, 3e9};
  static const std::vector<hid_t> types{H5T_IEEE_F64LE, H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_IEEE_F64BE,
                                        H5T_STD_I32LE,  H5T_STD_U8LE,   H5T_STD_I64LE,  H5T_STD_U16BE};
  std::vector<hsize_t> shape{hsize_t(cells[2]), hsize_t(cells[1]), hsize_t(cells[0])};
  if (dice.one_in(12)) shape[dice.below(3)] += 1;
  if (dice.one_in(20)) shape[dice.below(3)] = dice.of(std::vector<hsize_t>{0, 1, 2, 100});
  if (dice.one_in(25)) shape.push_back(3);
  if (dice.one_in(25)) shape.pop_back();
  if (dice.one_in(60)) shape.clear();
  const bool hole = dice.one_in(20), huge = dice.one_in(40);
  if (huge && !shape.empty()) shape[0] = hsize_t(1) << (30 + dice.below(30));
  const Hdf5Space space(shape.empty() ? H5Screate(dice.one_in(2) ? H5S_SCALAR : H5S_NULL)
                                      : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr));
  const Hdf5Property creation(H5Pcreate(H5P_DATASET_CREATE));
  if ((hole || huge) && !shape.empty()) {
    const std::vector<hsize_t> chunk(shape.size(), 1);
    (void)H5Pset_chunk(creation.get(), static_cast<int>(chunk.size()), chunk.data());
  }
  const Hdf5Type text(hdf5_string(5));
  const hid_t type = dice.one_in(40) ? text.get() : dice.of(types);
  const Hdf5Dataset dataset(
      H5Dcreate2(file, name.c_str(), type, space.get(), H5P_DEFAULT, creation.get(), H5P_DEFAULT));
  if (!dataset) return;
  if (!hole && !huge && type != text.get()) {
    std::size_t count = 1;
    for (const hsize_t n : shape) count *= n;
    std::vector<double> values(count);
    for (double &value : values) value = usual(name, dice);
    if (dice.one_in(4) && count > 0) values[dice.below(count)] = dice.of(odd);
    (void)H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }
  if (dice.one_in(30)) {
    const Hdf5Space scalar(H5Screate(H5S_SCALAR));
    const Hdf5Type word(hdf5_string(16));
    const Hdf5Attribute sum(H5Acreate2(dataset.get(), "checksum", word.get(), scalar.get(), H5P_DEFAULT, H5P_DEFAULT));
    (void)H5Awrite(sum.get(), word.get(), "0123456789abcdef");
  }
}

}  // namespace

void write_state(Dice &dice, const std::string &path, const int (&cells)[3]) {
  (void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Hdf5FileHandle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  const bool fluid = dice.one_in(4);
  for (std::size_t n = 1 + dice.below(6); n > 0; --n) {
    const std::string &name =
        dice.one_in(25) ? dice.of(odd_names) : state_names[dice.below(fluid ? 4 : state_names.size())];
    if (dice.one_in(50))
      (void)H5Lcreate_soft("/nowhere", file.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    else if (dice.one_in(50))
      (void)H5Lcreate_external("no_such.h5", "/x", file.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    else if (dice.one_in(50))
      (void)Hdf5Object(H5Gcreate2(file.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    else
      make_dataset(dice, file.get(), name, cells);
  }
  if (!fluid && dice.one_in(2) && H5Lexists(file.get(), "solid_fraction", H5P_DEFAULT) <= 0)
    make_dataset(dice, file.get(), "solid_fraction", cells);
}

void change_objects(Dice &dice, const std::string &path) {
  const Hdf5FileHandle file(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
  if (!file) return;
  H5G_info_t info{};
  (void)H5Gget_info(file.get(), &info);
  std::vector<std::string> names;
  for (hsize_t n = 0; n < info.nlinks; ++n) {
    char name[128] = "";
    (void)H5Lget_name_by_idx(file.get(), ".", H5_INDEX_NAME, H5_ITER_INC, n, name, sizeof name, H5P_DEFAULT);
    names.emplace_back(name);
  }
  if (names.empty()) return;
  const std::string &name = dice.of(names), &other = dice.of(names);
  const int cells[3] = {static_cast<int>(1 + dice.below(20)), static_cast<int>(1 + dice.below(20)), 1};
  switch (dice.below(6)) {
    case 0:
      (void)H5Ldelete(file.get(), name.c_str(), H5P_DEFAULT);
      break;
    case 1:
      (void)H5Ldelete(file.get(), name.c_str(), H5P_DEFAULT);
      make_dataset(dice, file.get(), name, cells);
      break;
    case 2:
      (void)H5Lmove(file.get(), name.c_str(), file.get(), (name + "_").c_str(), H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 3:  // one dataset under the name of another: its checksum is right
      (void)H5Ldelete(file.get(), name.c_str(), H5P_DEFAULT);
      (void)H5Lcreate_hard(file.get(), other.c_str(), file.get(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 4:
      (void)H5Adelete_by_name(file.get(), name.c_str(), "checksum", H5P_DEFAULT);
      break;
    default: {
      const std::vector<std::string> attributes{"kind", "format", "version"};
      const std::string &attribute = dice.of(attributes);
      (void)H5Adelete_by_name(file.get(), "/", attribute.c_str(), H5P_DEFAULT);
      if (dice.one_in(2)) return;
      const hsize_t two = 2;
      const Hdf5Space space(dice.one_in(2) ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &two, nullptr));
      const Hdf5Type text(hdf5_string(9));
      const hid_t type = dice.one_in(2) ? text.get() : H5T_NATIVE_LONG;
      const Hdf5Attribute made(H5Acreate_by_name(file.get(), "/", attribute.c_str(), type, space.get(), H5P_DEFAULT,
                                                 H5P_DEFAULT, H5P_DEFAULT));
      const long values[4] = {2, 3, 4, 5};
      (void)H5Awrite(made.get(), type, values);
    }
  }
}

}  // namespace eulastic::fuzz
