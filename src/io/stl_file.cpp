#include "io/stl_file.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace eulastic {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;
constexpr std::size_t most_triangles = 500'000'000;

bool is_finite(const Triangle &triangle) {
  for (const Real3 &corner : triangle)
    for (const double x : corner)
      if (!std::isfinite(x)) return false;
  return true;
}

std::string read_binary(std::ifstream &stream, std::size_t count, std::vector<Triangle> *triangles) {
  char bytes[triangle_bytes];
  triangles->reserve(count);
  for (std::size_t t = 0; t < count; ++t) {
    if (!stream.read(bytes, triangle_bytes)) return "cannot be read";
    float numbers[9];
    std::memcpy(numbers, bytes + 12, sizeof numbers);
    Triangle triangle;
    for (int n = 0; n < 9; ++n) triangle[n / 3][n % 3] = numbers[n];
    if (!is_finite(triangle)) return "triangle " + std::to_string(t + 1) + " has a corner that is not finite";
    triangles->push_back(triangle);
  }
  return {};
}

class AsciiReader {
public:
  explicit AsciiReader(std::ifstream &stream) : stream_(stream) {}

  std::string read(std::vector<Triangle> *triangles) {
    std::string line;
    std::getline(stream_, line);  // solid and any name
    for (std::string word; stream_ >> word;) {
      if (word == "endsolid") {
        ended_ = true;
        std::getline(stream_, line);
      } else if (word == "solid") {  // another one
        ended_ = false;
        std::getline(stream_, line);
      } else {
        Triangle triangle;
        if (ended_ || word != "facet" || !read_facet(&triangle) || !is_finite(triangle))
          return "triangle " + std::to_string(triangles->size() + 1) +
                 " is not complete (facet normal, outer loop, three vertices x y z, endloop, endfacet): it is "
                 "truncated or damaged";
        triangles->push_back(triangle);
      }
    }
    return ended_ ? "" : "has no endsolid, it is truncated or damaged";
  }

private:
  bool expect(const char *wanted) {
    std::string word;
    return stream_ >> word && word == wanted;
  }
  bool read_number(double *number) {
    std::string word;
    if (!(stream_ >> word)) return false;
    const char *begin = word.data() + (word[0] == '+');
    const auto [stop, status] = std::from_chars(begin, word.data() + word.size(), *number);
    return status == std::errc{} && stop == word.data() + word.size();
  }
  bool read_facet(Triangle *triangle) {
    std::string normal;
    if (!expect("normal") || !(stream_ >> normal >> normal >> normal) || !expect("outer") || !expect("loop"))
      return false;
    for (Real3 &corner : *triangle) {
      if (!expect("vertex")) return false;
      for (double &x : corner)
        if (!read_number(&x)) return false;
    }
    return expect("endloop") && expect("endfacet");
  }

  std::ifstream &stream_;
  bool ended_ = false;
};

}  // namespace

std::string read_stl(const std::string &file, std::vector<Triangle> *triangles) {
  triangles->clear();
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  char header[header_bytes] = "";
  stream.read(header, header_bytes);
  const bool has_header = bool(stream);
  stream.clear();
  std::uint32_t count = 0;
  std::memcpy(&count, header + header_bytes - sizeof count, sizeof count);
  std::string wrong;
  // Binary files may begin with "solid" as well: their size tells.
  if (has_header && size == header_bytes + triangle_bytes * std::uintmax_t{count}) {
    if (count > most_triangles)
      return file + ": " + std::to_string(count) + " triangles; accepted: at most 500 million";
    wrong = read_binary(stream, count, triangles);
  } else if (std::strncmp(header, "solid", 5) == 0) {
    stream.seekg(0);
    wrong = AsciiReader(stream).read(triangles);
  } else {
    wrong = has_header ? "its size does not fit to " + std::to_string(count) + " triangles, it is truncated or damaged"
                       : "is too short for an STL file";
  }
  if (wrong.empty() && triangles->empty()) wrong = "has no triangles";
  return wrong.empty() ? wrong : file + ": " + wrong;
}

}  // namespace eulastic
