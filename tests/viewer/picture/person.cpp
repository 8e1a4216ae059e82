#include "tests/viewer/picture/person.hpp"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include "common/base/error.hpp"

namespace palpate::test {

struct Person::Impl {
  Display* display = nullptr;
  Window window = 0;
  Time clock = 1000;  ///< ms
  ~Impl() {
    if (display != nullptr) XCloseDisplay(display);
  }
  int x = 0, y = 0;  ///< position of the pointer

  void find(const std::string& title);
  void button(int type, long mask) {
    XEvent event{};
    event.xbutton.type = type;
    event.xbutton.display = display;
    event.xbutton.window = window;
    event.xbutton.root = DefaultRootWindow(display);
    event.xbutton.same_screen = True;
    event.xbutton.time = clock += 500;
    event.xbutton.x = x;
    event.xbutton.y = y;
    event.xbutton.button = Button1;
    send(event, mask);
  }
  void send(XEvent& event, long mask) {
    XSendEvent(display, window, False, mask, &event);
    XSync(display, False);
  }
};

void Person::Impl::find(const std::string& title) {
  Window root = 0, parent = 0, *children = nullptr;
  unsigned count = 0;
  XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count);
  for (unsigned n = 0; n < count; ++n) {
    char* name = nullptr;
    if (XFetchName(display, children[n], &name) == 0) continue;
    if (name == title) window = children[n];
    XFree(name);
  }
  if (children != nullptr) XFree(children);
}

Person::Person(const std::string& screen, const std::string& title)
    : impl_(std::make_unique<Impl>()) {
  impl_->display = XOpenDisplay(screen.c_str());
  if (impl_->display == nullptr) throw failure("cannot open the display {}", screen);
  XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });  // ignores events to a closed window
  impl_->find(title);
  if (impl_->window == 0) throw failure("no window \"{}\" on {}", title, screen);
}

Person::~Person() = default;

void Person::closeWindow() {
  XEvent event{};
  event.xclient.type = ClientMessage;
  event.xclient.window = impl_->window;
  event.xclient.message_type = XInternAtom(impl_->display, "WM_PROTOCOLS", False);
  event.xclient.format = 32;
  event.xclient.data.l[0] =
      static_cast<long>(XInternAtom(impl_->display, "WM_DELETE_WINDOW", False));
  impl_->send(event, NoEventMask);
}

void Person::press(const char* key) {
  for (const int type : {KeyPress, KeyRelease}) {
    XEvent event{};
    event.xkey.type = type;
    event.xkey.display = impl_->display;
    event.xkey.window = impl_->window;
    event.xkey.root = DefaultRootWindow(impl_->display);
    event.xkey.same_screen = True;
    event.xkey.time = impl_->clock += 500;
    event.xkey.keycode = XKeysymToKeycode(impl_->display, XStringToKeysym(key));
    impl_->send(event, type == KeyPress ? KeyPressMask : KeyReleaseMask);
  }
}

void Person::pointAt(int x, int y) {
  impl_->x = x;
  impl_->y = y;
  XWarpPointer(impl_->display, None, impl_->window, 0, 0, 0, 0, x, y);
  XSync(impl_->display, False);
}

void Person::holdButton() { impl_->button(ButtonPress, ButtonPressMask); }
void Person::letButtonGo() { impl_->button(ButtonRelease, ButtonReleaseMask); }

}  // namespace palpate::test
