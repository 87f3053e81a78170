#include "io/nrrd_header.hpp"

#include "base/number_rows.hpp"
#include "base/one_line.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace eulastic {
namespace {

using Words = std::vector<std::string>;

// White space, commas and parentheses separate: "(1,0,0) (0,1,0)" has six words.
Words words_of(std::string text) {
  for (char &c : text)
    if (c == ',' || c == '(' || c == ')') c = ' ';
  std::istringstream stream(text);
  Words words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

struct Type {
  int bytes;
  bool is_float;
  Words names;
};

const std::vector<Type> types{
    {1, false, {"signed char", "int8", "int8_t", "uchar", "unsigned char", "uint8", "uint8_t"}},
    {2, false, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"}},
    {2, false, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
    {4, false, {"int", "signed int", "int32", "int32_t", "uint", "unsigned int", "uint32", "uint32_t"}},
    {8, false, {"longlong", "long long", "long long int", "signed long long", "signed long long int"}},
    {8, false, {"ulonglong", "unsigned long long", "unsigned long long int"}},
    {8, false, {"int64", "int64_t", "uint64", "uint64_t"}},
    {4, true, {"float"}},
    {8, true, {"double"}}};

constexpr double tilt_of_round_off = 1e-6;  // of a direction: a voxel in the longest row that is accepted

class HeaderReader {
public:
  HeaderReader(std::map<std::string, std::string> fields, NrrdHeader *header)
      : fields_(std::move(fields)), header_(header) {}

  std::string read() {
    for (const char *name : {"line skip", "lineskip", "byte skip", "byteskip"})
      if (has(name) && fields_[name] != "0") return std::string("field ") + name + " is not supported; accepted: 0";
    for (const char *name : {"axis mins", "axismins", "axis maxs", "axismaxs"})
      if (has(name)) return std::string("field ") + name + " is not supported; accepted: spacings and space origin";
    for (const auto step :
         {&HeaderReader::read_sizes, &HeaderReader::read_kinds, &HeaderReader::read_type, &HeaderReader::read_place})
      if (std::string wrong = (this->*step)(); !wrong.empty()) return wrong;
    return {};
  }

private:
  static bool is_any(double) { return true; }
  bool has(const std::string &name) const { return fields_.count(name) > 0; }

  // The error message about the value of a field.
  std::string refuse(const std::string &name, const std::string &accepted, const std::string &why = {}) {
    return name + " \"" + fields_[name] + "\"" + why + "; accepted: " + accepted;
  }

  // Reads `count` numbers that are `fine`. Returns whether the field has them.
  template <class Fine>
  bool read_numbers(const std::string &name, std::size_t count, std::vector<double> *numbers, const Fine &fine) {
    numbers->clear();
    for (const std::string &word : words_of(fields_[name])) {
      double number = 0;
      if (!read_number(word, &number) || !fine(number)) return false;
      numbers->push_back(number);
    }
    return numbers->size() == count;
  }

  std::string read_sizes() {
    std::vector<double> dimension, sizes;
    if (!read_numbers("dimension", 1, &dimension, [](double n) { return n == 2 || n == 3; }))
      return refuse("dimension", "2 or 3");
    rank_ = static_cast<std::size_t>(dimension[0]);
    const auto fine = [](double n) { return n >= 1 && n < 1e15 && n == std::floor(n); };
    if (!read_numbers("sizes", rank_, &sizes, fine)) return refuse("sizes", std::to_string(rank_) + " integers >= 1");
    header_->sizes.assign(sizes.begin(), sizes.end());
    return {};
  }

  // Axes that are no directions in space would become one.
  std::string read_kinds() {
    if (!has("kinds")) return {};
    const Words kinds = words_of(fields_["kinds"]);
    const auto spatial = [](const std::string &kind) {
      const std::string name = lower_case(kind);
      return name == "domain" || name == "space" || name == "none" || name == "???";
    };
    const auto other = std::find_if_not(kinds.begin(), kinds.end(), spatial);
    if (kinds.size() == rank_ && other == kinds.end()) return {};
    return refuse(
        "kinds", "domain or space for each of the " + std::to_string(rank_) + " axes",
        other == kinds.end() ? "" : ": axis " + std::to_string(other - kinds.begin() + 1) + " is not in space");
  }

  std::string read_type() {
    const auto is_named = [&](const Type &type) {
      return std::find(type.names.begin(), type.names.end(), fields_["type"]) != type.names.end();
    };
    const auto type = std::find_if(types.begin(), types.end(), is_named);
    if (type == types.end()) return refuse("type", "signed or unsigned integers of 1 to 8 bytes, float, double");
    header_->bytes = type->bytes;
    header_->is_float = type->is_float;
    const std::string encoding = lower_case(fields_["encoding"]), endian = lower_case(fields_["endian"]);
    if (encoding == "gzip" || encoding == "gz")
      header_->encoding = NrrdHeader::Encoding::gzip;
    else if (encoding == "ascii" || encoding == "text" || encoding == "txt")
      header_->encoding = NrrdHeader::Encoding::ascii;
    else if (encoding != "raw")
      return refuse("encoding", "raw, gzip, ascii");
    header_->big_endian = endian == "big";
    const bool any_endian = header_->bytes == 1 || header_->encoding == NrrdHeader::Encoding::ascii;
    if (endian == "big" || endian == "little" || (endian.empty() && any_endian)) return {};
    return refuse("endian", "little or big");
  }

  std::string read_place() {
    if (has("space directions") && has("spacings"))
      return "has both spacings and space directions; accepted: one of them";
    if (std::string wrong = has("space directions") ? read_directions() : read_spacings(); !wrong.empty()) return wrong;
    if (!has("space origin")) return {};
    if (!read_numbers("space origin", rank_, &header_->corner, [](double x) { return std::isfinite(x); }))
      return refuse("space origin", "(x,y,z), finite");
    // The format's origin is the centre of the first voxel.
    for (std::size_t d = 0; d < header_->spacing.size(); ++d) header_->corner[d] -= header_->spacing[d] / 2;
    return {};
  }

  std::string read_directions() {
    std::vector<double> numbers;
    const std::string rank = std::to_string(rank_);
    if (!read_numbers("space directions", rank_ * rank_, &numbers, is_any))
      return refuse("space directions", rank + " vectors of " + rank + " numbers");
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      const bool diagonal = n % (rank_ + 1) == 0;
      const double along = numbers[n / rank_ * (rank_ + 1)];
      if (diagonal ? !(numbers[n] > 0) : !(std::fabs(numbers[n]) <= tilt_of_round_off * along))
        return refuse("space directions", "(dx,0,0) (0,dy,0) (0,0,dz), all > 0", " are not along x, y, z");
      if (diagonal) header_->spacing.push_back(numbers[n]);
    }
    return {};
  }

  std::string read_spacings() {
    if (!has("spacings")) return {};
    if (!read_numbers("spacings", rank_, &header_->spacing, is_any))
      return refuse("spacings", std::to_string(rank_) + " numbers > 0");
    const auto is_unknown = [](double s) { return std::isnan(s); };
    if (std::all_of(header_->spacing.begin(), header_->spacing.end(), is_unknown)) header_->spacing.clear();
    return {};
  }

  std::map<std::string, std::string> fields_;
  NrrdHeader *header_;
  std::size_t rank_ = 0;
};

bool is_detached(const std::map<std::string, std::string> &fields) {
  return fields.count("data file") > 0 || fields.count("datafile") > 0;
}

// The values are behind the header, or in a file that a detached header names, beside it.
std::string find_data(const std::string &file, const std::map<std::string, std::string> &fields, NrrdHeader *header) {
  namespace fs = std::filesystem;
  header->data_file = file;
  if (!is_detached(fields)) return {};
  const auto named = fields.find("data file");
  const std::string name = named != fields.end() ? named->second : fields.at("datafile");
  header->data_file = (fs::path(file).parent_path() / name).string();
  header->data = 0;
  std::error_code ignored;
  if (fs::is_regular_file(header->data_file, ignored)) return {};
  return "its data file " + header->data_file + " is not a file; accepted: the name of one file, beside the header";
}

}  // namespace

std::string read_nrrd_header(const std::string &file, NrrdHeader *header) {
  constexpr std::size_t longest = 1 << 16;
  std::ifstream stream(file, std::ios::binary);
  std::map<std::string, std::string> fields;
  std::string text(longest, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(longest));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  const bool all = text.size() < longest;
  header->data = -1;
  for (std::size_t begin = byte_order_mark_length(text); begin < text.size();) {
    std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) {
      if (!all || !is_detached(fields)) break;
      end = text.size();
    }
    std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    for (char &c : line)
      if (std::iscntrl(static_cast<unsigned char>(c)) && c != '\t') c = '?';  // it may be quoted, in one line
    if (line.empty()) {
      header->data = static_cast<std::int64_t>(begin);
      break;
    }
    const std::size_t colon = line.find(": ");
    const bool key = line.find(":=") < colon;
    if (line[0] == '#' || key || line.compare(0, 4, "NRRD") == 0) continue;
    if (colon == std::string::npos)
      return file + ": header line \"" + line.substr(0, 80) + "\" is not a field; accepted: FIELD: VALUE";
    std::string value = line.substr(colon + 2);
    value.erase(0, value.find_first_not_of(" \t"));
    value.erase(value.find_last_not_of(" \t") + 1);
    if (!fields.emplace(lower_case(line.substr(0, colon)), value).second)
      return file + ": field " + line.substr(0, colon) + " is given twice; accepted: once";
  }
  if (header->data < 0 && !(all && is_detached(fields)))
    return file + ": the NRRD header has no end, it is truncated or damaged";
  std::string wrong = find_data(file, fields, header);
  if (wrong.empty()) wrong = HeaderReader(std::move(fields), header).read();
  return wrong.empty() ? wrong : file + ": " + wrong;
}

}  // namespace eulastic
