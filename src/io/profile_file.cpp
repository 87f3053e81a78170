#include "io/profile_file.hpp"

#include "io/hdf5_input.hpp"

#include <algorithm>
#include <cmath>

namespace eulastic {
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
    return said + " has no numbers";
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
    return said + " has values that are not finite";
  values->resize(cells);
  for (std::size_t c = 0; c < cells; ++c) (*values)[c] = vector ? sign * all[3 * c + std::size_t(component)] : all[c];
  return {};
}

}  // namespace eulastic
