// What Json writes can be read.
#include "io/json.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace eulastic {
namespace {

// Reads JSON strictly: keys with their path ("bodies.0.id") and the text of every value.
class JsonReader {
public:
  explicit JsonReader(const std::string &text) : text_(text) {
    value("");
    space();
    fine_ = fine_ && at_ == text_.size();
  }
  bool fine() const { return fine_; }
  const std::vector<std::string> &keys() const { return keys_; }
  std::string operator[](const std::string &key) const { return values_.count(key) ? values_.at(key) : "missing"; }

private:
  void space() { at_ = std::min(text_.find_first_not_of(" \n", at_), text_.size()); }
  bool take(char c) {
    space();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  std::string string() {
    std::string result;
    if (!take('"')) fine_ = false;
    while (fine_ && at_ < text_.size() && text_[at_] != '"') {
      if (static_cast<unsigned char>(text_[at_]) < 0x20) fine_ = false;
      if (text_[at_] == '\\') result += text_[at_++];
      result += text_[at_++];
    }
    fine_ = fine_ && take('"');
    return result;
  }
  void value(const std::string &path) {
    if (!fine_) return;
    const auto child = [&](const std::string &name) { return path.empty() ? name : path + "." + name; };
    if (take('{')) {
      if (take('}')) return;
      do {
        const std::string key = child(string());
        fine_ = fine_ && take(':');
        keys_.push_back(key);
        value(key);
      } while (fine_ && take(','));
      fine_ = fine_ && take('}');
    } else if (take('[')) {
      if (take(']')) return;
      int n = 0;
      do value(child(std::to_string(n++)));
      while (fine_ && take(','));
      fine_ = fine_ && take(']');
    } else if (space(), at_ < text_.size() && text_[at_] == '"') {
      values_[path] = string();
    } else {
      const std::size_t end = std::min(text_.find_first_of(",]} \n", at_), text_.size());
      const std::string word = text_.substr(at_, end - at_);
      char *rest = nullptr;
      if (word != "null") (void)std::strtod(word.c_str(), &rest);
      fine_ = word == "null" || (!word.empty() && *rest == 0 && word.find_first_not_of("-+.e0123456789") == word.npos);
      values_[path] = word;
      at_ = end;
    }
  }

  std::string text_;
  std::size_t at_ = 0;
  bool fine_ = true;
  std::vector<std::string> keys_;
  std::map<std::string, std::string> values_;
};

TEST(Json, WhatItWritesCanBeRead) {
  const JsonReader json(Json()
                            .add("text", std::string("a \"quoted\" \\ back\nslash"))
                            .add("third", 1.0 / 3)
                            .add("nan", std::nan(""))
                            .add("vector", std::array<double, 3>{1, -INFINITY, 1e-7})
                            .add("none", std::vector<Json>{})
                            .add("list", std::vector<Json>{Json().add("n", 1L), Json().add("n", -2L), Json()})
                            .text());
  EXPECT_TRUE(json.fine());
  EXPECT_EQ(json["text"], "a \\\"quoted\\\" \\\\ back\\u000aslash");
  EXPECT_EQ(json["third"], "0.33333333333333331");
  EXPECT_EQ(json["nan"], "null");
  EXPECT_EQ(json["vector.1"], "null");
  EXPECT_EQ(json["vector.2"], "9.9999999999999995e-08");
  EXPECT_EQ(json["list.1.n"], "-2");
  for (const char *broken : {"{", "{\"a\": nan}", "{\"a\": 1,}", "{\"a\" 1}", "{\"a\": 1}}", "{\"a\": [1 2]}"})
    EXPECT_FALSE(JsonReader(broken).fine()) << broken;
}

}  // namespace
}  // namespace eulastic
