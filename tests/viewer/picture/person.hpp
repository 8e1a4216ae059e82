#pragma once

#include <memory>
#include <string>

namespace palpate::test {

/// Another program on the same screen, that finds a window by its title and sends it what a person
/// would do.
class Person {
 public:
  /// Error when there is no such window.
  Person(const std::string& screen, const std::string& title);
  ~Person();
  Person(const Person&) = delete;
  Person& operator=(const Person&) = delete;

  void closeWindow();
  /// Down and up. key: X11's name of it, "q", "space", "F5".
  void press(const char* key);
  /// Pixels of the window, from its upper left.
  void pointAt(int x, int y);
  /// The left button, where the pointer is.
  void holdButton();
  void letButtonGo();

 private:
  struct Impl;  // X11's headers define words like None
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::test
