#include "io/stl_file.hpp"

#include "base/number_rows.hpp"
#include "base/one_line.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace eulastic {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;
constexpr std::size_t most_triangles = 500'000'000;

std::uintmax_t size_of(const std::string &file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  return error ? 0 : size;
}

bool is_finite(const Triangle &triangle) {
  for (const Real3 &corner : triangle)
    for (const double x : corner)
      if (!std::isfinite(x)) return false;
  return true;
}

// Where a solid of a binary file may begin, and what is left from there on.
struct Solid {
  std::uint32_t count = 0;
  bool fits = false;  ///< its triangles are in the file
};

Solid solid_at(std::ifstream &stream, std::uintmax_t begin, std::uintmax_t size) {
  Solid solid;
  char header[header_bytes];
  stream.clear();
  if (begin + header_bytes > size || !stream.seekg(static_cast<std::streamoff>(begin)) ||
      !stream.read(header, header_bytes))
    return solid;
  std::memcpy(&solid.count, header + header_bytes - sizeof solid.count, sizeof solid.count);
  solid.fits = begin + header_bytes + triangle_bytes * std::uintmax_t{solid.count} <= size;
  return solid;
}

std::string read_triangles(std::ifstream &stream, std::size_t count, std::vector<Triangle> *triangles) {
  char bytes[triangle_bytes];
  if (triangles->size() + count > most_triangles) return "has too many triangles; accepted: at most 500 million";
  triangles->reserve(triangles->size() + count);
  for (std::size_t t = 0; t < count; ++t) {
    if (!stream.read(bytes, triangle_bytes)) return "cannot be read";
    float numbers[9];
    std::memcpy(numbers, bytes + 12, sizeof numbers);
    Triangle triangle;
    for (int n = 0; n < 9; ++n) triangle[n / 3][n % 3] = numbers[n];
    if (!is_finite(triangle))
      return "triangle " + std::to_string(triangles->size() + 1) + " has a corner that is not finite";
    triangles->push_back(triangle);
  }
  return {};
}

// One solid after the other; less than a header, or zeros, may follow the last one.
std::string read_binary(std::ifstream &stream, std::uintmax_t size, std::vector<Triangle> *triangles) {
  for (std::uintmax_t begin = 0; begin == 0 || begin + header_bytes <= size;) {
    const Solid solid = solid_at(stream, begin, size);
    if (begin > 0 && solid.count == 0) break;
    if (!solid.fits && begin > 0)
      return "the data after its " + std::to_string(triangles->size()) +
             " triangles is not another solid; the file is damaged";
    if (!solid.fits)
      return begin + header_bytes > size
                 ? "is too short for an STL file"
                 : "its size does not match " + std::to_string(solid.count) + " triangles, it is truncated or damaged";
    if (std::string wrong = read_triangles(stream, solid.count, triangles); !wrong.empty()) return wrong;
    begin += header_bytes + triangle_bytes * std::uintmax_t{solid.count};
  }
  return {};
}

class AsciiReader {
public:
  explicit AsciiReader(std::ifstream &stream) : stream_(stream) {}

  std::string read(std::vector<Triangle> *triangles) {
    skip_line();  // solid and any name
    for (std::string word; next(&word);) {
      if (word == "endsolid") {
        ended_ = true;
        skip_line();
      } else if (word == "solid") {  // another one
        ended_ = false;
        skip_line();
      } else {
        Triangle triangle;
        if (ended_ && is_padding(word)) continue;
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
  // Zeros, and the end of a file as DOS had it.
  static bool is_padding(const std::string &word) {
    return std::all_of(word.begin(), word.end(), [](char c) { return c == '\0' || c == '\x1a'; });
  }
  void skip_line() {
    for (int c = stream_.get(); c != '\n' && c != '\r' && c != std::char_traits<char>::eof();) c = stream_.get();
  }
  bool next(std::string *word) {
    if (!(stream_ >> *word)) return false;
    *word = lower_case(*word);
    return true;
  }
  bool expect(const char *wanted) {
    std::string word;
    return next(&word) && word == wanted;
  }
  bool read_coordinate(double *number) {
    std::string word;
    return stream_ >> word && read_number(word, number);
  }
  bool read_facet(Triangle *triangle) {
    std::string normal;
    if (!expect("normal") || !(stream_ >> normal >> normal >> normal) || !expect("outer") || !expect("loop"))
      return false;
    for (Real3 &corner : *triangle) {
      if (!expect("vertex")) return false;
      for (double &x : corner)
        if (!read_coordinate(&x)) return false;
    }
    return expect("endloop") && expect("endfacet");
  }

  std::ifstream &stream_;
  bool ended_ = false;
};

// Whether a file is a text that begins with "solid", and leaves the stream before this word. Headers of binary files
// may begin so too: these are of the right size, or their count of triangles has a byte 0.
bool begins_as_text(std::ifstream &stream, std::uintmax_t size) {
  const Solid solid = solid_at(stream, 0, size);
  if (solid.fits && size == header_bytes + triangle_bytes * std::uintmax_t{solid.count}) return false;
  char bytes[header_bytes + 1] = "";
  stream.clear();
  stream.seekg(0);
  stream.read(bytes, header_bytes);
  std::string text(bytes, static_cast<std::size_t>(stream.gcount()));
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n", byte_order_mark_length(text)), text.size());
  text = lower_case(text);
  stream.clear();
  stream.seekg(static_cast<std::streamoff>(begin));
  return text.compare(begin, 5, "solid") == 0 && text.find('\0') == std::string::npos;
}

}  // namespace

bool is_stl(const std::string &file) {
  std::ifstream stream(file, std::ios::binary);
  const std::uintmax_t size = size_of(file);
  const Solid solid = solid_at(stream, 0, size);
  if (solid.fits && solid.count > 0) {
    const std::uintmax_t end = header_bytes + triangle_bytes * std::uintmax_t{solid.count};
    if (const Solid next = solid_at(stream, end, size); next.fits || next.count == 0) return true;
  }
  return begins_as_text(stream, size);
}

std::string read_stl(const std::string &file, std::vector<Triangle> *triangles) {
  triangles->clear();
  std::ifstream stream(file, std::ios::binary);
  const std::uintmax_t size = size_of(file);
  std::string wrong =
      begins_as_text(stream, size) ? AsciiReader(stream).read(triangles) : read_binary(stream, size, triangles);
  if (wrong.empty() && triangles->empty()) wrong = "has no triangles; accepted: the closed surface of a body";
  return wrong.empty() ? wrong : file + ": " + wrong;
}

}  // namespace eulastic
