// Begin: curves, then the view; where there is no WebGL the pictures stay.
"use strict";

(async () => {
  const curves = castx.json("curves");
  if (curves !== null) castx.charts.draw(document, curves);
  const scene = castx.json("scene"), root = document.getElementById("view");
  if (scene === null || root === null) return;
  try {
    const view = new castx.View(scene, root.querySelector("canvas"));
    await view.load();
    root.classList.add("live"); // before the first picture: the canvas has no size while it is hidden
    const controls = new castx.Controls(view, root);
    await controls.start();
    castx.view = view;
    castx.controls = controls;
    for (const link of document.querySelectorAll("[data-show]")) {
      link.hidden = !scene.fields.some((field) => field.name === link.dataset.show);
      link.addEventListener("click", () => {
        const time = Number(link.dataset.time);
        const apart = scene.times.map((found) => Math.abs(found - time));
        controls.show({ field: link.dataset.show, moment: apart.indexOf(Math.min(...apart)) });
        root.scrollIntoView({ behavior: "smooth" });
      });
    }
  } catch (error) {
    root.classList.remove("live");
    root.querySelector(".missing").hidden = false;
    root.querySelector(".missing").title = String(error);
  }
  root.dataset.ready = "yes";
})();
