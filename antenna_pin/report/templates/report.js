"use strict";
// A table that does not fit is scrolled sideways; only such a one shows that it can be.
(function () {
  const boxes = Array.from(document.querySelectorAll(".scroll"));
  const mark = (box) => {
    const more = box.scrollWidth - box.clientWidth - box.scrollLeft;
    box.classList.toggle("more", more > 1);
  };
  const all = () => boxes.forEach(mark);
  boxes.forEach((box) => box.addEventListener("scroll", () => mark(box), { passive: true }));
  document.querySelectorAll("details").forEach((part) => part.addEventListener("toggle", all));
  window.addEventListener("resize", all);
  all();
})();
