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

bool to_numbers(const std::string &text, std::vector<double> *numbers) {
  numbers->clear();
  for (const std::string &word : words_of(text)) {
    double number = 0;
    if (!read_number(word, &number)) return false;
    numbers->push_back(number);
  }
  return true;
}

struct Type {
  int bytes;
  bool is_float;
};

const std::map<std::string, Type> types = [] {
  std::map<std::string, Type> map{
      {"signed char", {1, false}}, {"uchar", {1, false}}, {"float", {4, true}}, {"double", {8, true}}};
  const std::map<int, Words> integers{
      {2, {"short", "short int"}}, {4, {"int"}}, {8, {"longlong", "long long", "long long int"}}};
  for (const char *name : {"int8", "uint8"}) map[name] = map[std::string(name) + "_t"] = {1, false};
  map["unsigned char"] = {1, false};
  for (const auto &[bytes, names] : integers) {
    for (const std::string &name : names)
      for (const char *sign : {"", "signed ", "unsigned "}) map[sign + name] = {bytes, false};
    map["u" + names[0]] = {bytes, false};
    for (const char *sign : {"int", "uint"})
      for (const char *end : {"", "_t"}) map[sign + std::to_string(8 * bytes) + end] = {bytes, false};
  }
  return map;
}();

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
  bool has(const std::string &name) const { return fields_.count(name) > 0; }

  std::string read_sizes() {
    std::vector<double> dimension, sizes;
    if (!to_numbers(fields_["dimension"], &dimension) || dimension.size() != 1 ||
        (dimension[0] != 2 && dimension[0] != 3))
      return "dimension \"" + fields_["dimension"] + "\"; accepted: 2 or 3";
    rank_ = static_cast<std::size_t>(dimension[0]);
    const auto fine = [](double n) { return n >= 1 && n < 1e15 && n == std::floor(n); };
    if (!to_numbers(fields_["sizes"], &sizes) || sizes.size() != rank_ ||
        !std::all_of(sizes.begin(), sizes.end(), fine))
      return "sizes \"" + fields_["sizes"] + "\"; accepted: " + std::to_string(rank_) + " integers >= 1";
    for (const double n : sizes) header_->sizes.push_back(static_cast<unsigned long long>(n));
    return {};
  }

  // Axes that are no directions in space would become one.
  std::string read_kinds() {
    const auto given = fields_.find("kinds");
    if (given == fields_.end()) return {};
    const Words kinds = words_of(given->second);
    const auto spatial = [](const std::string &kind) {
      const std::string name = lower_case(kind);
      return name == "domain" || name == "space" || name == "none" || name == "???";
    };
    const auto other = std::find_if_not(kinds.begin(), kinds.end(), spatial);
    if (kinds.size() == rank_ && other == kinds.end()) return {};
    return "kinds \"" + given->second + "\"" +
           (other == kinds.end() ? "" : ": axis " + std::to_string(other - kinds.begin() + 1) + " is not in space") +
           "; accepted: domain or space for each of the " + std::to_string(rank_) + " axes";
  }

  std::string read_type() {
    const auto type = types.find(fields_["type"]);
    if (type == types.end())
      return "type \"" + fields_["type"] + "\"; accepted: signed or unsigned integers of 1 to 8 bytes, float, double";
    header_->bytes = type->second.bytes;
    header_->is_float = type->second.is_float;
    const std::string encoding = lower_case(fields_["encoding"]);
    if (encoding == "gzip" || encoding == "gz")
      header_->encoding = NrrdHeader::Encoding::gzip;
    else if (encoding == "ascii" || encoding == "text" || encoding == "txt")
      header_->encoding = NrrdHeader::Encoding::ascii;
    else if (encoding != "raw")
      return "encoding \"" + encoding + "\"; accepted: raw, gzip, ascii";
    const std::string endian = lower_case(fields_["endian"]);
    header_->big_endian = endian == "big";
    if (endian != "big" && endian != "little" &&
        !(endian.empty() && (header_->bytes == 1 || header_->encoding == NrrdHeader::Encoding::ascii)))
      return "endian \"" + endian + "\"; accepted: little or big";
    return {};
  }

  std::string read_place() {
    std::vector<double> numbers;
    if (has("space directions") && has("spacings")) return "has both spacings and space directions; accepted: one";
    if (has("space directions")) {
      if (!to_numbers(fields_["space directions"], &numbers) || numbers.size() != rank_ * rank_)
        return "space directions \"" + fields_["space directions"] + "\"; accepted: " + std::to_string(rank_) +
               " vectors of " + std::to_string(rank_) + " numbers";
      for (std::size_t n = 0; n < numbers.size(); ++n) {
        const bool diagonal = n % (rank_ + 1) == 0;
        const double along = numbers[n / rank_ * (rank_ + 1)];
        if (diagonal ? !(numbers[n] > 0) : !(std::fabs(numbers[n]) <= tilt_of_round_off * along))
          return "space directions \"" + fields_["space directions"] +
                 "\" are not along x, y, z; accepted: (dx,0,0) (0,dy,0) (0,0,dz), all > 0";
        if (diagonal) header_->spacing.push_back(numbers[n]);
      }
    } else if (has("spacings")) {
      if (!to_numbers(fields_["spacings"], &numbers) || numbers.size() != rank_)
        return "spacings \"" + fields_["spacings"] + "\"; accepted: " + std::to_string(rank_) + " numbers > 0";
      const auto unknown = [](double s) { return std::isnan(s); };
      if (!std::all_of(numbers.begin(), numbers.end(), unknown)) header_->spacing = numbers;
    }
    if (!has("space origin")) return {};
    if (!to_numbers(fields_["space origin"], &numbers) || numbers.size() != rank_ ||
        !std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); }))
      return "space origin \"" + fields_["space origin"] + "\"; accepted: (x,y,z), finite";
    header_->corner = numbers;  // the format's origin is the centre of the first voxel
    for (std::size_t d = 0; d < header_->spacing.size(); ++d) header_->corner[d] -= header_->spacing[d] / 2;
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
    if (colon == std::string::npos) return file + ": header line \"" + line.substr(0, 80) + "\" is no field: value";
    std::string value = line.substr(colon + 2);
    value.erase(0, value.find_first_not_of(" \t"));
    value.erase(value.find_last_not_of(" \t") + 1);
    if (!fields.emplace(lower_case(line.substr(0, colon)), value).second)
      return file + ": field " + line.substr(0, colon) + " is given twice";
  }
  if (header->data < 0 && !(all && is_detached(fields)))
    return file + ": the NRRD header has no end, it is truncated or damaged";
  std::string wrong = find_data(file, fields, header);
  if (wrong.empty()) wrong = HeaderReader(std::move(fields), header).read();
  return wrong.empty() ? wrong : file + ": " + wrong;
}

}  // namespace eulastic
