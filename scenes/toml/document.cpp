/// A text becomes a tree of nodes; overrides then change nodes of it, in their order, as if the file
/// had them. Whoever reads the tree does not see the difference, but for the place in a fault: where()
/// gives the override that a node came from.
///
/// toml++ is kept from two kinds of text that it cannot stand: keys nested without end (KeyDepthScan),
/// and such as it takes for granted to be TOML (not_toml.h).
#include "brink/scenes/toml/document.h"

#include <sstream>

#include "brink/scenes/toml/not_toml.h"

namespace brink {
namespace {

/// Parts of one path, also of an override's. bodies.gas.scatter.region.0.1 has six.
constexpr int kMaxKeyDepth = 64;

/// What stands before the first '=' of each override: how faults call it.
std::vector<std::string> paths_of(const std::vector<std::string>& overrides) {
  std::vector<std::string> paths;
  for (const std::string& text : overrides) paths.push_back(text.substr(0, text.find('=')));
  return paths;
}

// The parser bounds the nesting of arrays, but "a.a.a..." makes tables without end, and they are freed by
// recursion: finds a dotted key of more than kMaxKeyDepth parts. Strings and comments are skipped.
class KeyDepthScan {
 public:
  explicit KeyDepthScan(std::string_view text) : text_(text) {}

  /// Line of the first key that is too deep, or 0.
  /// Dots are counted since the last character that ends a key or a value: those of a number, too, which
  /// reaches the next comma or line long before the limit.
  /// Never says so of a text that is sound TOML with keys of up to kMaxKeyDepth parts.
  int first_too_deep() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '"' || c == '\'')
        skip_string(c);
      else if (c == '#')
        skip_comment();
      else if (c == '.' && ++dots_ >= kMaxKeyDepth)
        return line_;
      else if (std::string_view(",=[]{}\n").find(c) != std::string_view::npos)
        dots_ = 0;
      // Also the newline on which skip_string() has stopped.
      if (at_ < text_.size() && text_[at_] == '\n') ++line_;
    }
    return 0;
  }

 private:
  // Stops before the newline, so that the line is counted and the key ends there.
  void skip_comment() {
    while (at_ + 1 < text_.size() && text_[at_ + 1] != '\n') ++at_;
  }
  void skip_string(char quote) {
    const std::string triple(3, quote);
    const bool multi = text_.substr(at_, 3) == triple;
    // Ends on the last quote, or on the newline that an open string ends at, which the caller counts.
    at_ += multi ? 3 : 1;
    for (; at_ < text_.size(); ++at_) {
      // Only basic strings know escapes: in a literal one ('...') a backslash is itself.
      if (text_[at_] == '\\' && quote == '"')
        ++at_;
      else if (multi && text_.substr(at_, 3) == triple)
        return skip_closing(quote);
      else if (!multi && (text_[at_] == quote || text_[at_] == '\n'))
        return;
      if (at_ < text_.size() && text_[at_] == '\n') ++line_;
    }
  }

  // The string may itself end in one or two quotes: of three to five in a row the last three close it.
  void skip_closing(char quote) {
    at_ += 2;
    for (int own = 0; own < 2 && at_ + 1 < text_.size() && text_[at_ + 1] == quote; ++own) ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
  int dots_ = 0;
};

// "a.b.0" as {"a", "b", "0"}; a part in quotes may hold dots; "a[0]" is the same as "a.0".
// Never fails: a part that nobody has, or an empty one, is told by the walk along the path.
std::vector<std::string> path_parts(std::string_view path) {
  std::vector<std::string> parts{""};
  char quote = 0;
  for (const char c : path) {
    if (quote != 0) {
      // A quote of the other kind is a character of the part.
      if (c == quote)
        quote = 0;
      else
        parts.back() += c;
    } else if (c == '"' || c == '\'')
      quote = c;
    else if (c == '.' || c == '[')
      parts.emplace_back();
    else if (c != ']')
      parts.back() += c;
  }
  return parts;
}

// The value of an override: as TOML if it reads as one value, else the text itself.
// A second line would go on to keys of its own (`--set "title=1\nworld.seed=2"`), which nobody would
// read: such a value is a string.
toml::table as_value(std::string_view text) {
  if (text.find('\n') == std::string_view::npos) {
    const std::string line = "value = " + std::string(text);
    try {
      if (KeyDepthScan(line).first_too_deep() == 0) return toml::parse(line);
    } catch (const toml::parse_error&) {
      // Not TOML: then it is a text, so that `--set 'title=two words'` needs no second pair of quotes.
    } catch (const NotToml&) {
    }
  }
  return toml::table{{"value", std::string(text)}};
}

/// The line of a text that is NotToml: the last of the shortest beginning that is it, too.
int line_of(std::string_view text) {
  std::vector<std::size_t> ends;
  for (std::size_t at = text.find('\n'); at != std::string_view::npos; at = text.find('\n', at + 1))
    ends.push_back(at + 1);
  // The last line need not end in a newline.
  ends.push_back(text.size());
  // The parser reads from front to back, so a beginning that fails its assertion makes every longer one
  // fail, and bisection over the number of lines finds the first. The whole text is known to fail.
  std::size_t sound = 0, fault = ends.size();  // so many lines
  while (fault - sound > 1) {
    const std::size_t middle = (sound + fault) / 2;
    try {
      static_cast<void>(toml::parse(text.substr(0, ends[middle - 1])));
      sound = middle;
    } catch (const toml::parse_error&) {
      sound = middle;  // cut off in the middle of something
    } catch (const NotToml&) {
      fault = middle;
    }
  }
  return static_cast<int>(fault);
}

/// Reads `part` as a whole number; true if it is one below `size`. Else `*index` is not told.
bool is_index(const std::string& part, std::size_t size, std::size_t* index) {
  // Nine digits at most: stoul cannot overflow.
  if (part.empty() || part.size() > 9 || part.find_first_not_of("0123456789") != std::string::npos)
    return false;
  *index = std::stoul(part);
  return *index < size;
}

// Index of the table in `array` whose name is `name`, or the array's size. One without a name is called by `unnamed`, if
// that is not empty, and its index.
// So `bodies.ball.mass=2` finds the body called "ball" wherever it stands in the file.
std::size_t index_of_name(const toml::array& array, const std::string& name, const std::string& unnamed) {
  for (std::size_t i = 0; i < array.size(); ++i)
    if (const toml::table* table = array[i].as_table()) {
      const auto* text = table->get_as<std::string>("name");
      if (text != nullptr && text->get() == name) return i;
      if (!table->contains("name") && !unnamed.empty() && name == unnamed + std::to_string(i)) return i;
    }
  return array.size();
}

/// What the entries of an array are called, for who names one that there is not: "; the nearest is ...", or nothing.
std::string nearest_entry(const toml::node& node, const std::string& part) {
  std::vector<std::string> names;
  if (const toml::array* array = node.as_array())
    for (const toml::node& entry : *array)
      if (const toml::table* table = entry.as_table())
        if (const auto* name = table->get_as<std::string>("name")) names.push_back(name->get());
  return names.empty() ? "" : "; the nearest is " + in_quotes(nearest_word(part, names));
}

}  // namespace

TomlDocument::TomlDocument(std::string_view text, const std::vector<std::string>& overrides,
                           DefaultNames unnamed)
    : faults_(paths_of(overrides)), unnamed_(std::move(unnamed)) {
  parse(text);
  readable_ = faults_.empty();
  // After a syntax error there is nothing to override, and an override's fault would hide it among others.
  for (std::size_t i = 0; readable_ && i < overrides.size(); ++i) apply(overrides[i], static_cast<int>(i));
}

/// Fills the tree, or tells the one fault that there is: after it nothing is known of the rest.
void TomlDocument::parse(std::string_view text) {
  if (const int line = KeyDepthScan(text).first_too_deep(); line > 0) {
    faults_.add({line, 1},
                "a dotted key has too many parts: " + std::to_string(kMaxKeyDepth) + " are allowed");
    return;
  }
  try {
    root_ = toml::parse(text);
  } catch (const toml::parse_error& error) {
    const auto& at = error.source().begin;
    // What the parser has not placed has line 0; places count from 1.
    faults_.add({std::max(1, static_cast<int>(at.line)), std::max(1, static_cast<int>(at.column))},
                "not valid TOML: " + std::string(error.description()));
  } catch (const NotToml& error) {
    faults_.add({line_of(text), 1}, std::string("not valid TOML: ") + error.what());
  }
}

/// One override. Its faults have no line: they are told by its path.
void TomlDocument::apply(const std::string& override_text, int index) {
  const Where here{0, 0, index};
  const std::size_t equals = override_text.find('=');
  if (equals == std::string::npos || equals == 0)
    return faults_.add(here, "an override must be PATH=VALUE, given " + in_quotes(override_text));
  const std::vector<std::string> parts = path_parts(std::string_view(override_text).substr(0, equals));
  if (parts.size() > static_cast<std::size_t>(kMaxKeyDepth))
    return faults_.add(here, "the path has too many parts: " + std::to_string(kMaxKeyDepth) + " are allowed");
  // All parts but the last lead to a table or an array, the last one is what is set in it.
  toml::node* node = &root_;
  for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
    toml::node* next = step(*node, i > 0 ? parts[i - 1] : std::string(), parts[i]);
    // A table that the file does not have is made ("world.gravity=..." in a scene without [world]). An
    // array never grows.
    if (next == nullptr && node->is_table()) {
      node->as_table()->insert_or_assign(parts[i], toml::table{});
      next = node->as_table()->get(parts[i]);
      mark(*next, index);
    }
    if (next == nullptr)
      return faults_.add(here, "nothing is called " + in_quotes(parts[i]) +
                                   " there; an array takes an index from 0, " +
                                   "or the name of one of its entries" + nearest_entry(*node, parts[i]));
    node = next;
  }
  const toml::table parsed = as_value(std::string_view(override_text).substr(equals + 1));
  assign(*node, parts.back(), *parsed.get("value"), index);
}

// An index goes before a name; a number that is no index of the array may still be one.
toml::node* TomlDocument::step(toml::node& node, const std::string& key, const std::string& part) {
  if (toml::table* table = node.as_table()) return table->get(part);
  toml::array* array = node.as_array();
  if (array == nullptr) return nullptr;
  std::size_t index = 0;
  if (!is_index(part, array->size(), &index)) {
    const auto unnamed = unnamed_.find(key);
    index = index_of_name(*array, part, unnamed == unnamed_.end() ? std::string() : unnamed->second);
  }
  return index < array->size() ? &(*array)[index] : nullptr;
}

/// Sets the entry or element `part` of `parent`, whatever was there. In an array only what is there
/// already can be set, and by its index alone.
void TomlDocument::assign(toml::node& parent, const std::string& part, const toml::node& value, int index) {
  if (toml::table* table = parent.as_table()) {
    // A node of toml++ is copied by its concrete type.
    value.visit([&](const auto& concrete) { table->insert_or_assign(part, concrete); });
    return mark(*table->get(part), index);
  }
  toml::array* array = parent.as_array();
  std::size_t at = 0;
  if (array == nullptr || !is_index(part, array->size(), &at))
    return faults_.add({0, 0, index},
                       "nothing is called " + in_quotes(part) + " there; " +
                           (array == nullptr ? "the path goes through " + given(parent)
                                             : "the array has " + std::to_string(array->size()) +
                                                   " elements, counted from 0"));
  value.visit([&](const auto& concrete) {
    array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(at), concrete);
  });
  mark((*array)[at], index);
}

/// The node, and all within it, were said by that override.
void TomlDocument::mark(const toml::node& node, int index) {
  // By address: toml++ keeps nodes apart from the tables that hold them, so they stay where they are as
  // other keys come in.
  override_of_[&node] = index;
  if (const toml::array* array = node.as_array())
    for (const toml::node& element : *array) mark(element, index);
  if (const toml::table* table = node.as_table())
    for (const auto& [key, value] : *table) mark(value, index);
}

Where TomlDocument::where(const toml::node& node) const {
  if (const auto found = override_of_.find(&node); found != override_of_.end()) return {0, 0, found->second};
  // What the parser has not placed has line 0.
  const auto& at = node.source().begin;
  return {std::max(1, static_cast<int>(at.line)), std::max(1, static_cast<int>(at.column))};
}

// The key's own place is best for a key that is unknown; what an override brings in has no place in the
// file, neither of key nor of value.
Where TomlDocument::where(const toml::key& key, const toml::node& value) const {
  const auto& at = key.source().begin;
  if (override_of_.contains(&value) || at.line == 0) return where(value);
  return {static_cast<int>(at.line), std::max(1, static_cast<int>(at.column))};
}

// Tables and arrays are told by their kind: they may be as long as the file.
std::string given(const toml::node& node) {
  if (const auto* text = node.as_string()) return "the string " + in_quotes(text->get());
  if (const auto* number = node.as_floating_point()) return number_text(number->get());
  if (const auto* number = node.as_integer()) return std::to_string(number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const toml::array* array = node.as_array()) return "an array of " + std::to_string(array->size());
  if (node.is_table()) return "a table";
  return "a date or time";
}

}  // namespace brink
