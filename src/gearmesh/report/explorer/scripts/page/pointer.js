// Pointer and keyboard on the pictures. It uses what main.js declares.

function placeOf(event) {
  const box = event.currentTarget.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}

function listenToPictures() {
  const dragged = canvases.diagram;
  const follow = (event) => {
    setNu(+diagram.frame.fromX(placeOf(event)[0]).toFixed(4));
    tip = null;
    changed();
  };
  dragged.addEventListener("pointerdown", (event) => {
    dragged.setPointerCapture(event.pointerId);
    follow(event);
  });
  dragged.addEventListener("pointermove", (event) => {
    if (event.buttons) return void follow(event);
    tip = diagram.nearest(...placeOf(event));
    request();
  });
  const point = (find) => (event) => { tip = null; cursor = find(...placeOf(event)); request(); };
  canvases.plane.addEventListener("pointermove", point((x, y) => plane.nearest(x, y)));
  canvases.course.addEventListener("pointermove", point((x) => timeCourse.sampleAt(x)));
  canvases.course.addEventListener("pointerdown", point((x) => timeCourse.sampleAt(x)));
  for (const canvas of Object.values(canvases)) {
    canvas.addEventListener("pointerleave", () => { tip = null; request(); });
    canvas.addEventListener("keydown", (event) => {
      const direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!direction) return;
      event.preventDefault();
      if (canvas === canvases.diagram) {
        setNu(view.nu + direction * (event.shiftKey ? 0.01 : 0.001));
        return void changed();
      }
      cursor = clamp((cursor ?? 0) + direction * (event.shiftKey ? 32 : 4), 0, course.count - 1);
      request();
    });
  }
}
