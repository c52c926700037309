#include "settings_file.h"

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>

#include "error.h"
#include "file_aside.h"
#include "number.h"

namespace oclair {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// What tune can say it has measured.
constexpr const char* measured_names[] = {"bias", "biasBound", "rootMeanSquareBias", "confidence", "error", "speed", "variance", "timeToEqualError"};

[[noreturn]] void refuse(const fs::path& file, std::size_t line, const std::string& what) {
  throw Error(Exit::scene, file.string() + ":" + std::to_string(line) + ": " + what);
}

// Knows the line of the last character that the parser has taken: it takes one more after a number.
struct CountedText {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  const char* at;
  std::size_t* line;
  char previous = ' ';

  reference operator*() const { return *at; }
  CountedText& operator++() {
    *line += previous == '\n';
    previous = *at++;
    return *this;
  }
  CountedText operator++(int) {
    CountedText before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountedText& other) const { return at == other.at; }
  bool operator!=(const CountedText& other) const { return at != other.at; }
};

// A value with its name, and the name of the object that it stands in; empty: the outermost.
struct Entry {
  std::string object, name, value;
  std::size_t line;
};

// Takes text and numbers in an object and in the objects that stand in it, and nothing else.
class Entries : public nlohmann::json_sax<Json> {
 public:
  Entries(const fs::path& file, const std::size_t& line) : file_(file), line_(line) {}

  std::vector<Entry> take() { return std::move(entries_); }

  bool null() override { unexpected("null"); }
  bool boolean(bool) override { unexpected("a truth value"); }
  bool number_integer(number_integer_t number) override { return add(std::to_string(number)); }
  bool number_unsigned(number_unsigned_t number) override { return add(std::to_string(number)); }
  bool number_float(number_float_t, const string_t& text) override { return add(text); }
  bool string(string_t& text) override { return add(text); }
  bool binary(binary_t&) override { unexpected("binary data"); }
  bool start_array(std::size_t) override { unexpected("a list"); }
  bool end_array() override { return true; }
  bool start_object(std::size_t) override {
    if (++depth_ > 2) unexpected("an object in an object in an object");
    if (depth_ == 2) {
      if (name_ != "settings" && name_ != "measured")
        refuse(file_, key_line_, "unknown object \"" + one_line(name_) + "\", expected settings or measured");
      require_new();
      object_ = name_;
    }
    return true;
  }
  bool end_object() override {
    --depth_;
    object_.clear();
    return true;
  }
  bool key(string_t& name) override {
    name_ = name;
    key_line_ = line_;
    return true;
  }
  bool parse_error(std::size_t, const std::string& token, const Json::exception&) override {
    refuse(file_, line_, "is no JSON at '" + one_line(token.substr(0, 80)) + "'; expected a settings file of oclair tune");
  }

 private:
  [[noreturn]] void unexpected(const std::string& what) {
    refuse(file_, line_, what + (name_.empty() ? "" : " as \"" + one_line(name_) + "\"") + ", expected text or a number");
  }
  void require_new() {
    if (const auto [before, is_new] = lines_.emplace(std::pair(object_, name_), key_line_); !is_new)
      refuse(file_, key_line_, "\"" + one_line(name_) + "\" stands in line " + std::to_string(before->second) + " already, expected it once");
  }
  bool add(const std::string& value) {
    if (depth_ == 0) unexpected("a value outside of an object");
    require_new();
    entries_.push_back({object_, name_, value, key_line_});
    return true;
  }

  const fs::path& file_;
  const std::size_t& line_;
  int depth_ = 0;
  std::string object_, name_;
  std::size_t key_line_ = 1;
  std::vector<Entry> entries_;
  std::map<std::pair<std::string, std::string>, std::size_t> lines_;  // by object and name
};

std::string read_text(const fs::path& file) {
  constexpr std::size_t most = 1 << 20;  // bytes
  std::error_code ignored;
  if (fs::exists(file, ignored) && !fs::is_regular_file(file, ignored))  // a pipe would wait for its writer
    throw Error(Exit::scene, file.string() + ": is no regular file, expected a settings file of oclair tune");
  std::ifstream stream(file, std::ios::binary);
  std::string text(most + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.is_open() || stream.bad())
    throw Error(Exit::scene, file.string() + ": cannot be read, expected a settings file of oclair tune");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > most) throw Error(Exit::scene, file.string() + ": is larger than 1 MiB, expected a settings file of oclair tune");
  return text;
}

std::string choice_names() {
  std::string names;
  for (const Choice& choice : choices()) names += (names.empty() ? "" : ", ") + std::string(choice.name);
  return names;
}

}  // namespace

SettingsFile read_settings(const fs::path& file) {
  const std::string text = read_text(file);
  std::size_t line = 1;
  Entries found(file, line);
  Json::sax_parse(CountedText{text.data(), &line}, CountedText{text.data() + text.size(), &line}, &found);
  SettingsFile settings;
  for (const Entry& entry : found.take()) {
    const std::string quoted = "\"" + one_line(entry.name) + "\"";
    if (entry.object.empty()) {
      if (entry.name == "program") settings.program = entry.value;
      else if (entry.name == "scene") settings.scene = entry.value;
      else if (entry.name == "sceneHash") settings.scene_hash = entry.value;
      else refuse(file, entry.line, "unknown name " + quoted + ", expected program, scene, sceneHash, settings or measured");
    } else if (entry.object == "settings") {
      const Choice* const choice = find_choice(entry.name);
      if (!choice) refuse(file, entry.line, "unknown setting " + quoted + ", expected one of " + choice_names());
      try {
        choice->set(settings.choices, entry.value, choice->name);
      } catch (const Error& error) {
        refuse(file, entry.line, error.what());
      }
    } else {  // measured
      if (std::find(std::begin(measured_names), std::end(measured_names), entry.name) == std::end(measured_names))
        refuse(file, entry.line, "unknown measure " + quoted + ", expected one of those that oclair tune writes");
      if (!parse_number(entry.value)) refuse(file, entry.line, quoted + " is '" + one_line(entry.value) + "', expected a number");
      settings.measured.emplace_back(entry.name, entry.value);
    }
  }
  return settings;
}

void write_settings(const fs::path& file, const SettingsFile& settings) {
  nlohmann::ordered_json json = {{"program", settings.program}, {"scene", settings.scene}, {"sceneHash", settings.scene_hash}};
  json["settings"] = nlohmann::ordered_json::object();
  for (const Choice& choice : choices())
    if (const std::string value = choice.get(settings.choices); !value.empty()) json["settings"][choice.name] = value;
  for (const auto& [name, value] : settings.measured)
    if (const auto number = parse_number(value)) json["measured"][name] = *number;
  write_text(file, json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

}  // namespace oclair
