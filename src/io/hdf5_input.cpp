#include "io/hdf5_input.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace eulastic {
namespace {

constexpr std::size_t chunk_cache = std::size_t{128} << 20;  // a layer of chunks is unpacked once
constexpr std::size_t most_names = 20;

#if H5_VERSION_GE(1, 12, 0)
using ObjectInfo = H5O_info2_t;
#else
using ObjectInfo = H5O_info_t;
#endif

// Takes the paths of datasets, except what MATLAB keeps for itself in #refs# and #subsystem#.
herr_t add_name(hid_t, const char *name, const ObjectInfo *info, void *names) {
  auto &all = *static_cast<std::vector<std::string> *>(names);
  if (info->type == H5O_TYPE_DATASET && name[0] != '#') all.emplace_back(name);
  return all.size() > most_names ? 1 : 0;
}

// Paths of the datasets of a file, each once: at most one more than most_names.
std::vector<std::string> dataset_names(hid_t file) {
  std::vector<std::string> names;
#if H5_VERSION_GE(1, 12, 0)
  (void)H5Ovisit3(file, H5_INDEX_NAME, H5_ITER_INC, add_name, &names, H5O_INFO_BASIC);
#else
  (void)H5Ovisit(file, H5_INDEX_NAME, H5_ITER_INC, add_name, &names);
#endif
  return names;
}

std::string listed(const std::vector<std::string> &names) {
  std::string text;
  for (std::size_t n = 0; n < std::min(names.size(), most_names); ++n) text += (n ? ", " : "") + names[n];
  return names.empty() ? "a file with datasets" : text + (names.size() > most_names ? ", ..." : "");
}

// Opens the dataset `name`; if this is empty `usual`, or else the only one.
std::string open_dataset(const std::string &file, const std::string &name, const std::string &usual, Hdf5Input *input) {
  const auto open = [input](const std::string &which) {
    input->name = which;
    input->dataset = Hdf5Dataset(H5Dopen2(input->file.get(), which.c_str(), H5P_DEFAULT));
    return bool(input->dataset);
  };
  if (open(name.empty() ? usual : name)) return {};
  const std::vector<std::string> names = dataset_names(input->file.get());
  if (name.empty()) {
    if (names.empty()) return file + " has no datasets; accepted: a file with one";
    if (names.size() > 1)
      return file + " has several datasets; accepted: " + file + ":DATASET, one of " + listed(names);
    if (open(names[0])) return {};
  }
  const std::string from_root = input->name.substr(std::min(input->name.find_first_not_of('/'), input->name.size()));
  if (std::find(names.begin(), names.end(), from_root) != names.end())
    return file + ": its dataset " + input->name + " cannot be opened, it is damaged";
  return file + ": there is no dataset " + name + "; accepted: " + listed(names);
}

}  // namespace

void split_dataset(const std::string &path, std::string *file, std::string *dataset) {
  std::error_code ignored;
  const std::size_t colon = path.rfind(':');
  const bool whole = colon == std::string::npos || std::filesystem::is_regular_file(path, ignored);
  *file = whole ? path : path.substr(0, colon);
  *dataset = whole ? std::string() : path.substr(colon + 1);
}

bool is_hdf5(const std::string &file) {
  char magic[8];
  std::ifstream stream(file, std::ios::binary);
  for (std::streamoff at = 0; stream.seekg(at) && stream.read(magic, sizeof magic); at = at == 0 ? 512 : 2 * at)
    if (std::memcmp(magic, "\x89HDF\r\n\x1a\n", sizeof magic) == 0) return true;
  return false;
}

std::string open_input(const std::string &file, const std::string &name, const std::string &usual, Hdf5Input *input) {
  (void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // the user sees our line
  const Hdf5Property access(H5Pcreate(H5P_FILE_ACCESS));
  (void)H5Pset_cache(access.get(), 0, 10007, chunk_cache, 1.0);
  input->file = Hdf5FileHandle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get()));
  if (!input->file) return file + " is damaged or truncated: HDF5 cannot open it";
  if (std::string wrong = open_dataset(file, name, usual, input); !wrong.empty()) return wrong;
  const Hdf5Property creation(H5Dget_create_plist(input->dataset.get()));
  // An external dataset would be in another file, a virtual one in many.
  if (H5Pget_external_count(creation.get()) > 0 || H5Pget_layout(creation.get()) == H5D_VIRTUAL)
    return file + ": dataset " + input->name + " lies in other files; accepted: datasets in one file";
  return {};
}

namespace {

template <class Numbers>
std::string listed(const Numbers &numbers) {
  std::string text;
  for (const auto n : numbers) text += (text.empty() ? "(" : ", ") + std::to_string(n);
  return text.empty() ? "()" : text + ")";
}

}  // namespace

std::string read_profile_file(const std::string &path, const std::string &dataset, int slow, int fast, int component,
                              double sign, std::vector<double> *values) {
  Hdf5Input input;
  if (std::string wrong = open_input(path, dataset, "velocity", &input); !wrong.empty()) return wrong;
  const std::string said = path + ": dataset " + input.name;
  const Hdf5Type type(H5Dget_type(input.dataset.get()));
  if (const H5T_class_t kind = H5Tget_class(type.get()); kind != H5T_FLOAT && kind != H5T_INTEGER)
    return said + " has no numbers; accepted: integers or floating-point numbers";
  const std::vector<hsize_t> shape = hdf5_shape(input.dataset.get());
  std::vector<std::vector<hsize_t>> accepted{{hsize_t(slow), hsize_t(fast)}, {hsize_t(slow), hsize_t(fast), 3}};
  if (slow == 1) {
    accepted.push_back({hsize_t(fast)});
    accepted.push_back({hsize_t(fast), 3});
  }
  const auto found = std::find(accepted.begin(), accepted.end(), shape);
  if (found == accepted.end())
    return said + " has the shape " + listed(shape) + "; accepted: " + listed(accepted[0]) + " or " +
           listed(accepted[1]) + ", the cells of the boundary, slowest first";
  const std::size_t cells = std::size_t(slow) * std::size_t(fast);
  const bool vector = (found - accepted.begin()) % 2 == 1;
  std::vector<double> all(vector ? 3 * cells : cells);
  if (H5Dread(input.dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()) < 0)
    return said + " cannot be read, it is truncated or damaged";
  if (!std::all_of(all.begin(), all.end(), [](double value) { return std::isfinite(value); }))
    return said + " has values that are not finite; accepted: finite numbers";
  values->resize(cells);
  for (std::size_t c = 0; c < cells; ++c) (*values)[c] = vector ? sign * all[3 * c + std::size_t(component)] : all[c];
  return {};
}

}  // namespace eulastic
