#include "fuzz/volume_files.hpp"

#include <zlib.h>
#include <algorithm>
#include <cstdint>
#include <cstring>

namespace eulastic::fuzz {
namespace {

using Words = std::vector<std::string>;

std::string gzip(const std::string &bytes) {
  z_stream stream{};
  std::string packed(bytes.size() + 100, '\0');
  if (deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK) return {};
  stream.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(bytes.data()));
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef *>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  (void)deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  (void)deflateEnd(&stream);
  return packed;
}

struct Type {
  Words names;
  int bytes;
  bool is_float;
};

template <class T>
void append(std::string *bytes, T value, bool big_endian) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  if (big_endian) std::reverse(raw, raw + sizeof value);
  bytes->append(raw, sizeof value);
}

std::string values(Dice &dice, const Type &type, bool ascii, bool big_endian, int count) {
  static const Words odd{"nan", "-1", "1.5", "1e300", "inf", "0x1", "1e", "2", "255"};
  std::string data;
  for (int v = 0; v < count; ++v) {
    const int value = static_cast<int>(dice.below(2));
    if (ascii)
      data += (dice.one_in(200) ? dice.of(odd) : std::to_string(value)) + (dice.one_in(8) ? "\n" : " ");
    else if (!type.is_float)
      for (int b = 0; b < type.bytes; ++b)
        data += static_cast<char>(b == (big_endian ? type.bytes - 1 : 0) ? value : 0);
    else if (type.bytes == 4)
      append(&data, static_cast<float>(value) * (dice.one_in(200) ? 2 : 0.5f), big_endian);
    else
      append(&data, value * 0.5, big_endian);
  }
  return data;
}

}  // namespace

std::string nrrd_volume(Dice &dice) {
  static const std::vector<Type> types{{{"uint8", "unsigned char", "int8_t"}, 1, false},
                                       {{"short", "uint16"}, 2, false},
                                       {{"int", "unsigned int"}, 4, false},
                                       {{"longlong", "uint64_t"}, 8, false},
                                       {{"float"}, 4, true},
                                       {{"double"}, 8, true}};
  static const Words encodings{"raw", "gzip", "ascii", "GZ", "txt"};
  static const Words extra{"space origin: (.1,.1,.1)",
                           "content: a cell",
                           "key:=value",
                           "# a comment",
                           "byte skip: 0",
                           "line skip: 1",
                           "space: left-posterior-superior",
                           "data file: other.raw"};
  const Type &type = dice.of(types);
  const std::string encoding = dice.of(encodings);
  const bool big_endian = dice.one_in(3), flat = dice.one_in(4);
  const bool packed = encoding[0] == 'g' || encoding[0] == 'G', ascii = encoding.find('t') != std::string::npos;
  Words fields{"type: " + dice.of(type.names), std::string("dimension: ") + (flat ? "2" : "3"),
               std::string("sizes: ") + (flat ? "6 8" : "4 4 3"), "encoding: " + encoding,
               std::string("endian: ") + (big_endian ? "big" : "little")};
  if (dice.one_in(2)) fields.emplace_back(flat ? "spacings: .1 .1" : "spacings: .2 .2 .2");
  if (dice.one_in(4)) fields.emplace_back("space directions: (.2,0,0) (0,.2,0) (0,0,.2)");
  if (dice.one_in(3)) fields.push_back(dice.of(extra));
  if (dice.one_in(2)) std::swap(fields[dice.below(fields.size())], fields[0]);
  std::string data = values(dice, type, ascii, big_endian, 48);
  if (packed) data = gzip(data);
  const std::string end = dice.one_in(6) ? "\r\n" : "\n";
  std::string header = "NRRD000" + std::to_string(1 + dice.below(5)) + end;
  switch (dice.below(8)) {
    case 0:
    case 1:
      break;
    case 2:
      fields.erase(fields.begin() + static_cast<long>(dice.below(fields.size())));
      break;
    case 3: {
      std::string &field = fields[dice.below(fields.size())];
      field = dice.spoil(field, 2);
      break;
    }
    case 4:
      data = dice.damage(data);
      break;
    case 5:
      data.resize(dice.below(data.size() + 1));
      break;
    case 6:
      data += dice.one_in(2) ? "x" : data;
      break;
    default:
      header = dice.spoil(header, 2);
  }
  for (const std::string &field : fields) header += field + end;
  if (!dice.one_in(40)) header += end;
  return dice.one_in(8) ? dice.spoil(header + data, 3) : header + data;
}

std::string stl_surface(Dice &dice) {
  const float corners[4][3] = {{.2f, .2f, .2f}, {.8f, .2f, .2f}, {.2f, .8f, .2f}, {.2f, .2f, .8f}};
  const int facets[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const bool ascii = dice.one_in(2), turned = dice.one_in(4);
  std::string bytes = ascii ? "solid cell\n" : std::string(80, dice.one_in(2) ? ' ' : 's');
  if (!ascii) append(&bytes, std::uint32_t{4}, false);
  for (const auto &facet : facets) {
    bytes += ascii ? " facet normal 0 0 0\n  outer loop\n" : std::string(12, '\0');
    for (int corner = 0; corner < 3; ++corner)
      for (int d = 0; d < 3; ++d) {
        const float x = corners[facet[turned ? 2 - corner : corner]][d];
        if (ascii)
          bytes += (d == 0 ? "   vertex " : " ") + std::to_string(x) + (d == 2 ? "\n" : "");
        else
          append(&bytes, x, false);
      }
    bytes += ascii ? "  endloop\n endfacet\n" : std::string(2, '\0');
  }
  if (ascii) bytes += "endsolid cell\n";
  if (dice.one_in(4)) return bytes;
  return ascii || dice.one_in(2) ? dice.spoil(bytes, 3) : dice.damage(bytes);
}

}  // namespace eulastic::fuzz
