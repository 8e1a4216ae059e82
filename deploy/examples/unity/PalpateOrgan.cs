// An organ in a Unity scene, felt and drawn: a sketch, compiled and run with Mono by the tests, NOT run in Unity.
//
// Put it on an object with a MeshFilter and a MeshRenderer, name a dataset in Assets/StreamingAssets, and give `tool` an object
// that is moved about, by a script or by hand in the Scene view. One unit of Unity is a metre: leave the scale of the organ at 1,
// and scale what is around it.
using System.IO;
using UnityEngine;

namespace PalpateClient {

/// Stands in for a device: the tool is where an object of the scene is, which knows no force. For a real one implement
/// IHapticDevice over its library, and write the force there.
public sealed class ToolObject : IHapticDevice {
  private readonly object gate = new object();
  private Vector3d position, force;
  private bool moved;

  public bool Lost => false;
  public bool Read(out Vector3d now) {
    lock (gate) {
      now = position;
      return moved;
    }
  }
  public void Write(Vector3d limited) { lock (gate) force = limited; }
  /// From Update(); frame of the organ in Unity.
  public void MoveTo(Vector3 place) {
    lock (gate) {
      position = Vector3d.FromUnity(place);
      moved = true;
    }
  }
  public Vector3 Force { get { lock (gate) return force.ToUnity(); } }
}

[RequireComponent(typeof(MeshFilter))]
public sealed class PalpateOrgan : MonoBehaviour {
  public string dataset = "liver-surface.h5";
  public string profile = "touch";  // of the device: its largest force and stiffness
  public Transform tool;

  private ToolObject hand;
  private HapticLoop loop;
  private Mesh mesh;
  private Vector3[] atRest, shape;
  private float[] displacements;

  /// N, on the tool, in the world.
  public Vector3 Force => transform.TransformDirection(hand.Force);

  // Loading takes seconds: for a scene that must not stop, open the dataset on another thread before.
  private void OnEnable() {
    hand = new ToolObject();
    loop = new HapticLoop(Path.Combine(Application.streamingAssetsPath, dataset), hand, profile);
    atRest = loop.Dataset.UnityVertices();
    shape = (Vector3[])atRest.Clone();
    displacements = new float[3 * atRest.Length];
    mesh = new Mesh { vertices = atRest, triangles = loop.Dataset.UnityTriangles() };
    mesh.MarkDynamic();
    mesh.RecalculateNormals();
    GetComponent<MeshFilter>().mesh = mesh;
  }

  private void Update() {
    if (tool != null) hand.MoveTo(transform.InverseTransformPoint(tool.position));
    loop.Deform(displacements);
    for (int n = 0; n < shape.Length; ++n)
      shape[n] = atRest[n] + new Vector3(displacements[3 * n], displacements[3 * n + 1], -displacements[3 * n + 2]);
    mesh.vertices = shape;
    mesh.RecalculateNormals();
    mesh.RecalculateBounds();
  }

  private void OnDisable() { loop.Dispose(); }
}

}  // namespace PalpateClient
